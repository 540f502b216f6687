#pragma once
// After the hemicubes: rays find what pixels missed, until fresh rays bound what is left.
#include <cstdint>

#include "bound/verification_rays.h"
#include "cell_set/cell_set.h"
#include "search/cell_search.h"
#include "search/near_polygons.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

struct finish_settings {
  double max_pixel_error = 1e-4;
  visibility_rules rules = {};           // whose volumes are told from those of the set
  double valid_share = 1.0;              // about this share of the grown box is free; decides the size of batches only
  std::uint64_t max_rays = 100'000'000;  // sight rays, tested places, and hemicubes by what they see
  std::uint64_t seed = 0, place = 0;
  const time_limit* limit = nullptr;  // null: none
  // A batch that the limit ends says nothing of what is missing. False: a look that has begun comes to its end.
  bool limit_ends_batches = false;
  std::uint64_t batches_before = 0;  // of this cell: their shares of the confidence are spent
  // With views: so many members were looked beside of, by guided or an earlier run, as far as for this error.
  std::size_t known = 0;
  double known_to = 1.0;
  const volume_grid* volumes = nullptr;  // that are looked for as well; null: none
};

struct finish_result {
  bool bound_met = false;
  std::uint64_t rays = 0, misses = 0;  // of the last whole batch; what missed has joined the set since
  double upper_bound = 1.0;            // holds with this batch's confidence
  double confidence = 0.0;
  std::uint64_t batches = 0;     // that were begun, with those before
  std::uint64_t rays_spent = 0;  // sight rays and tested places of all batches, and what the search spent
};

// Names the random numbers of a search after so many batches: others than those of the searches before it.
constexpr std::uint64_t seed_after(std::uint64_t batches, std::uint64_t seed) noexcept {
  return batches == 0 ? seed : mix_bits(seed + batches * 0x9E3779B97F4A7C15ull);
}

// A search, then batches of fresh rays: position uniform over the free points of the grown box, direction as the metric
// of the rules has it, all independent, so that for a fixed set the misses are binomial and the bound is exact. Batch j
// has the confidence share 0.05 / 2^j, divided among the looks at it (sequential_test.h): stopping at the first look
// that meets the target keeps 95 % for the whole run. Misses join with their position as witness, and the search goes
// on. A cell whose set only grew since an earlier run goes on counting batches: then all bounds of all runs hold
// together with 95 %, and the least of them is the cell's. Runs on the calling thread's TBB arena; the result does not
// depend on the number of threads. views: hemicubes that may be taken where more is missing than rays find; null: none.
finish_result finish_with_rays(const ray_scene& rays, const near_polygons& neighbors, const box& grown,
                               const finish_settings& how, cell_set& set, search_views* views = nullptr);

}  // namespace sightcell::bake
