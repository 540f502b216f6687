#pragma once
// Finds the casters of a cell: the polygons beside its camera set whose shadow falls on what the cell sees.
#include <cstdint>
#include <span>
#include <vector>

#include "casters/polygon_shadows.h"
#include "casters/sun_arc.h"
#include "search/near_polygons.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// The cell whose casters are searched for.
struct caster_cell {
  const viewpoint_region& region;
  double valid_share = 1.0;               // estimated share of the region that is valid viewpoints
  std::uint64_t place = 0;                // names its random numbers
  std::span<const std::uint32_t> camera;  // its camera set, ascending. The host draws all of it into the shadow map too
};

struct caster_search_settings {
  double max_error = 1e-4;  // target of the bound, above 0
  float player_radius = 0.05f;
  std::uint64_t seed = 1;
  std::uint64_t max_rays = 16'000'000;  // rays from viewpoints, of one cell and sun: more are cast only to end a batch
  std::uint32_t own_polygons = 0xFFFFFFFFu;  // polygons from this number on are drawn always (two_scenes.h)
};

struct caster_result {
  std::vector<std::uint32_t> casters;  // ascending, none of the camera set
  std::uint64_t rays = 0, misses = 0;  // of the batch with the smallest bound; its misses have joined since
  double upper_bound = 1.0;            // of the probability that a ray is a miss, one-sided Clopper-Pearson
  double confidence = 0.0;             // of the batch; 95 % for the whole run
  bool bound_met = false;
  std::uint64_t rays_spent = 0;
};

// Searches with rays, then casts batches of independent trials (shadow_batch.h) until one proves the bound, as
// finish_with_rays does for camera sets: the batches share the risk of 5 %, and misses join the set.
// Of the blockers of a missed shadow two join: the one nearest to the point, and the first from the light, whose depth
// the shadow map of everything has there.
// neighbors: polygons beside those that were found are tried by rays of their own; null: none.
// shadows: toward a direction of the sun; the polygons whose shadow falls on the camera set are tried by rays of their
// own where one search does not suffice (visible_shadows.h); null: none.
// Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
caster_result find_casters(const ray_scene& rays, const near_polygons* neighbors, const polygon_shadows* shadows,
                           const caster_cell& cell, const sun_arc& sun, const caster_search_settings& how);

// Tries polygons that cast shadows in other cells. Those whose shadow is visible from one of a few viewpoints join,
// with what else their shadows show to be lacking. The bound of the cell still holds, because its set only grows.
// casters: of the cell, ascending; receives those that join.
// candidates: any polygons.
// Returns the number of rays. Runs on the calling thread alone.
std::uint64_t try_casters(const ray_scene& rays, const near_polygons* neighbors, const caster_cell& cell,
                          const sun_arc& sun, const caster_search_settings& how,
                          std::span<const std::uint32_t> candidates, std::vector<std::uint32_t>& casters);

}  // namespace sightcell::bake
