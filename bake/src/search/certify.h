#pragma once
// Extends the set of a cell until verification rays prove the bound on its miss probability.
#include <cstdint>

#include "bound/verification_rays.h"
#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "search/cell_search.h"
#include "search/near_polygons.h"
#include "trace/ray_scene.h"
#include "trace/triangle_tree.h"
#include "trace/viewpoint_region.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

// A bound that verification rays proved before an edit of the scene. Its rays are cast again where the edit can have
// changed their result. Those that missed count as misses whatever they meet now. So the set may depend on them, and
// the bound is valid (docs/method/incremental.md).
struct cast_again {
  bound_rays of;
  std::uint64_t trials = 0, misses = 0;
  double confidence = 0.0;
  // Rays that pass no triangle of these have the result that they had.
  const triangle_tree* edited = nullptr;  // what was added or removed; must outlive the object
  triangle_tree left_out;                 // polygons that an earlier set has and this one lacks

  bool changed(const sight_line& ray) const {
    return (edited && edited->passes(ray.eye, ray.direction)) || left_out.passes(ray.eye, ray.direction);
  }
};

// The parameters of a run on one cell.
struct finish_settings {
  double max_pixel_error = 1e-4;  // target of the upper bound
  // Player radius, light-leak tolerance and metric. Its member `volumes` is replaced by one made from the set.
  visibility_rules rules = {};
  // Estimated share of the region that is valid viewpoints. Decides only the size of batches.
  double valid_share = 1.0;
  // Limit on the cost: sight rays, tested viewpoints, and hemicubes by what they show.
  std::uint64_t max_rays = 100'000'000;
  // Where these do not suffice for the target: number of rounds of search and verification after them, each with as
  // many rays again. Such a round begins with hemicubes, and each of its batches may cast that many.
  std::uint32_t further_rounds = 3;
  std::uint64_t seed = 0, place = 0;
  const time_limit* limit = nullptr;  // null: no limit
  // True: the time limit ends a batch at any ray, and that batch yields no estimate. False: an interim test that has
  // begun is completed.
  bool limit_ends_batches = false;
  std::uint64_t batches_before = 0;  // batches of this cell so far, whose shares of the confidence are spent
  // Batches before these, in earlier versions of the scene. What they missed is in the set, so their random numbers are
  // not used again. Their shares of the confidence are, because they bounded other sets.
  std::uint64_t batches_elsewhere = 0;
  // What the miss probability of the set probably is before the search. Where it is near the target, verification rays
  // come first. 1: nothing is known.
  double missing = 1.0;
  // Used if there are views: the number of members whose neighbors an earlier run tried, and the miss probability for
  // which that was done.
  std::size_t known = 0;
  double known_to = 1.0;
  const volume_grid* volumes = nullptr;  // visibility volumes to search for; null: none
  const cast_again* again = nullptr;     // rays of an earlier bound, tried before new ones; null: none
};

// The certificate of the cell and what it cost.
struct finish_result {
  bool bound_met = false;
  std::uint64_t rays = 0, misses = 0;  // of the batch with the smallest bound; its misses have joined the set since
  double upper_bound = 1.0;            // of the miss probability, with this batch's confidence
  double confidence = 0.0;
  bound_rays of_bound = {};      // that batch
  std::uint64_t batches = 0;     // begun so far, including earlier runs
  std::uint32_t rounds = 1;      // 1 and the further rounds that were begun
  std::uint64_t rays_spent = 0;  // sight rays and tested viewpoints of all batches, and the cost of the search
};

// Returns the seed of a search after this many batches, so that it uses other random numbers than earlier searches.
constexpr std::uint64_t seed_after(std::uint64_t batches, std::uint64_t seed) noexcept {
  return batches == 0 ? seed : mix_bits(seed + batches * 0x9E3779B97F4A7C15ull);
}

// Searches the cell, then casts batches of independent verification rays. The origin is uniform over the valid
// viewpoints of the region and the direction has the distribution of the metric, so for a fixed set the number of
// misses is binomial and the bound is exact.
//
// Batch j has the share 0.05 / 2^j of the confidence, divided among its interim tests (sequential_test.h). The run
// may stop at the first interim test that meets the target, and 95 % hold for the whole run. Missed polygons join the
// set with the ray's origin as witness, and the search continues. If a cell's set only grew since an earlier run,
// batches are numbered on: then the bounds of all runs hold together with 95 %, and the smallest of them is the
// cell's.
//
// views: hemicubes that may be rendered if more is missing than rays find; null: none.
// Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
finish_result finish_with_rays(const ray_scene& rays, const near_polygons& neighbors, const viewpoint_region& where,
                               const finish_settings& how, cell_set& set, search_views* views = nullptr);

}  // namespace sightcell::bake
