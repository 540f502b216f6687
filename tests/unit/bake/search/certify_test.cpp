#include "search/certify.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bound/clopper_pearson.h"
#include "bound/verification_rays.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::gridded_room;
using test::room_middle;
using test::scene_with_rays;

TEST(certify, goes_on_counting_batches) {
  const scene_with_rays w(gridded_room(5));
  const auto run = [&](std::uint64_t before) {
    cell_set set(w.s.polygon_count);
    return finish_with_rays(w.rays, w.neighbors, room_middle, {.max_pixel_error = 1e-3, .batches_before = before}, set);
  };
  const finish_result first = run(0), later = run(3);
  EXPECT_TRUE(first.bound_met && later.bound_met);
  EXPECT_GE(first.confidence, 1.0 - 0.05 / std::ldexp(1.0, static_cast<int>(first.batches)));
  EXPECT_GE(later.batches, 4u);
  EXPECT_GE(later.confidence, 1.0 - 0.05 / std::ldexp(1.0, static_cast<int>(later.batches)));
  EXPECT_GT(later.rays, first.rays) << "a smaller share of the risk takes more rays";
}

TEST(certify, has_no_bound_of_a_batch_that_its_limit_ends) {
  const scene_with_rays w(gridded_room(5));
  cell_set set(w.s.polygon_count);
  const time_limit over(1e-9, false);
  const finish_result result =
      finish_with_rays(w.rays, w.neighbors, room_middle,
                       {.max_pixel_error = 1e-3, .limit = &over, .limit_ends_batches = true, .batches_before = 2}, set);
  EXPECT_FALSE(result.bound_met);
  EXPECT_EQ(result.upper_bound, 1.0);
  EXPECT_EQ(result.rays, 0u);
  EXPECT_EQ(result.batches, 3u) << "it was begun: its share is spent";
}

TEST(certify, meets_the_bound_from_an_empty_set) {
  const scene_with_rays w(gridded_room(5));
  cell_set set(w.s.polygon_count);
  finish_settings how;
  how.max_pixel_error = 1e-3;
  const finish_result result = finish_with_rays(w.rays, w.neighbors, room_middle, how, set);
  EXPECT_TRUE(result.bound_met);
  EXPECT_LE(result.upper_bound, 1e-3);
  // A hundredth of the risk is for how many places are free.
  const double of_misses = 1.0 - 0.99 * (1.0 - result.confidence);
  EXPECT_NEAR(result.upper_bound / clopper_pearson_upper(result.misses, result.rays, of_misses), 1.0, 1e-9);
  EXPECT_GE(result.upper_bound, clopper_pearson_upper(result.misses, result.rays, result.confidence));
  EXPECT_GE(result.confidence, 0.975);
  EXPECT_EQ(set.size(), w.s.polygon_count);
}

TEST(certify, says_so_when_the_budget_ends_first) {
  const scene_with_rays w(gridded_room(5));
  cell_set set(w.s.polygon_count);
  finish_settings how;
  how.max_pixel_error = 1e-5;
  how.max_rays = 2'000;
  const finish_result result = finish_with_rays(w.rays, w.neighbors, room_middle, how, set);
  EXPECT_FALSE(result.bound_met);
  EXPECT_GT(result.upper_bound, 1e-5);
  EXPECT_LE(result.rays_spent, 10'000u);
}

TEST(certify, bounds_hold) {
  // Coverage: on a set with a known error, at least 95 % of one-batch bounds (here at 97.5 %) are above it.
  const scene_with_rays w(gridded_room(2));
  int below = 0;
  constexpr int seeds = 200;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto batch = cast_verification_rays(
        w.rays, {{-0.01f, -0.01f, -0.01f}, {0.01f, 0.01f, 0.01f}}, {.player_radius = 0.005f}, 200,
        {static_cast<std::uint64_t>(seed), 1, purpose::bound, 1}, [](std::uint32_t p) { return p >= 8; });
    below += clopper_pearson_upper(batch.misses, batch.rays, 0.95) < 1.0 / 6.0;
  }
  EXPECT_LE(below, 10 + 6);  // 5 % of 200, plus two standard errors
}

}  // namespace
}  // namespace sightcell::bake
