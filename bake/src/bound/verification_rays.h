#pragma once
// Verification rays: independent trials of a cell set, with rays from uniform valid viewpoints in random directions.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "bound/metric.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"
#include "volumes/volume_trial.h"

namespace sightcell::bake {

// A polygon that a verification ray met and the set lacks.
struct missed_polygon {
  std::uint32_t polygon = 0;
  glm::vec3 eye{0.0f};
  float distance = 0.0f;
  glm::vec3 direction{0.0f};
  bool counts = true;  // its ray counts as a miss, and rule 2 does not excuse the polygon
};

struct verification_batch {
  std::uint64_t rays = 0;    // rays cast: fewer than requested only if valid viewpoints are too rare
  std::uint64_t misses = 0;  // rays that count as a miss: they met a polygon that is missing without an excuse
  std::uint64_t viewpoints_tested = 0;       // points tested to find valid viewpoints
  std::vector<missed_polygon> missed;        // in a fixed order; all polygons that each ray missed
  std::uint64_t misses_of_volumes = 0;       // misses where only volumes count as missing
  std::vector<found_volume> missed_volumes;  // missed volumes; some more than once
  bool given_up = false;                     // rays and misses are then 0; missed has what was found so far
};

// Names the random numbers of a batch.
struct verification_stream {
  std::uint64_t seed = 0, place = 0;
  purpose use = purpose::bound;
  std::uint64_t round = 0;
};

// The rules that decide whether a ray is a miss. Rules 2 and 3 of docs/method/visibility-rules.md excuse missing
// polygons, and the metric decides which misses count. With volumes, a ray that passes a volume which the set lacks is
// a miss, whatever the metric.
struct visibility_rules {
  // Meters.
  float player_radius = 0.05f;
  float smallest_gap = 0.002f;
  const error_metric* metric = &pixel_metric;  // must outlive the rules
  const volume_trial* volumes = nullptr;       // of the same set; must outlive the rules. Null: no volumes
};

// Casts verification rays and returns what the set lacks.
// where: the box or region that viewpoints are drawn from.
// rules: what counts as a miss; its metric chooses the directions.
// count: number of rays.
// source: names the random numbers.
// contains: returns whether a polygon is in the set. Called from several threads.
// give_up: called from several threads. Once it returns true the batch is given up. Empty: never.
// Threads: runs in the TBB arena of the calling thread. The result depends on the arguments alone.
verification_batch cast_verification_rays(const ray_scene& rays, const viewpoint_region& where,
                                          const visibility_rules& rules, std::uint64_t count,
                                          const verification_stream& source,
                                          const std::function<bool(std::uint32_t)>& contains,
                                          const std::function<bool()>& give_up = {});

}  // namespace sightcell::bake
