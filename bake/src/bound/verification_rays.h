#pragma once
// Independent trials of a cell set: rays from uniform free positions in uniform directions.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "bound/metric.h"
#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "volumes/volume_trial.h"

namespace sightcell::bake {

// One polygon that a fresh ray saw and the set does not have.
struct missed_polygon {
  std::uint32_t polygon = 0;
  glm::vec3 eye{0.0f};
  float distance = 0.0f;
  glm::vec3 direction{0.0f};
  bool counts = true;  // its ray counts as a miss, and rule 2 does not excuse it
};

struct verification_batch {
  std::uint64_t rays = 0;    // cast; fewer than asked only where free places are too rare
  std::uint64_t misses = 0;  // rays that saw at least one polygon that is missing without an excuse, and count
  std::uint64_t places = 0;  // positions tested to find free ones
  std::vector<missed_polygon> missed;        // in a fixed order; a ray adds every polygon it missed
  std::uint64_t misses_of_volumes = 0;       // of the misses: they lack nothing that counts but volumes
  std::vector<found_volume> missed_volumes;  // the same for volumes; some more than once
  bool given_up = false;                     // then there are no rays and no misses, but what was found so far
};

struct verification_stream {
  std::uint64_t seed = 0, place = 0;
  purpose use = purpose::bound;
  std::uint64_t round = 0;
};

// What a ray is wrong about: rules 2 and 3 of seeing excuse (docs/method/error-certificate.md). And what that means.
// Where there are volumes a ray that passes one which the set lacks is wrong and counts, whatever the metric.
struct visibility_rules {
  float player_radius = 0.05f;
  float smallest_gap = 0.002f;
  const error_metric* metric = &pixel_metric;  // outlives the rules
  const volume_trial* volumes = nullptr;       // of the same set, outlives the rules; null: there are none
};

// Directions are those of the metric. Casts count rays on the calling thread's TBB arena. contains: is a polygon in the
// set? called from many threads. The result depends on the arguments alone. give_up: asked from many threads; once
// it is true the batch is given up.
verification_batch cast_verification_rays(const ray_scene& rays, const box& grown, const visibility_rules& rules,
                                          std::uint64_t count, const verification_stream& source,
                                          const std::function<bool(std::uint32_t)>& contains,
                                          const std::function<bool()>& give_up = {});

}  // namespace sightcell::bake
