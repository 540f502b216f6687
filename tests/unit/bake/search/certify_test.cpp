#include "search/certify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "bound/clopper_pearson.h"
#include "bound/verification_rays.h"
#include "hemicube/rays/rays_source.h"
#include "search/guided_views.h"
#include "unit/bake/gridded_room.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::gridded_room;
using test::room_middle;
using test::scene_with_rays;
using test::tiny_scene;

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

TEST(certify, casts_the_rays_of_an_earlier_bound_again) {
  const scene_with_rays w(gridded_room(5));
  cell_set set(w.s.polygon_count);
  finish_settings how{.max_pixel_error = 1e-3};
  const finish_result first = finish_with_rays(w.rays, w.neighbors, room_middle, how, set);
  ASSERT_TRUE(first.bound_met);
  ASSERT_EQ(first.of_bound.number, first.batches);
  cast_again again{first.of_bound, first.rays, first.misses, first.confidence, nullptr, {}};
  how.batches_before = first.of_bound.number;
  how.again = &again;
  const finish_result same = finish_with_rays(w.rays, w.neighbors, room_middle, how, set);
  EXPECT_TRUE(same.bound_met);
  EXPECT_EQ(same.upper_bound, first.upper_bound);
  EXPECT_EQ(same.batches, first.batches) << "no new one";
  EXPECT_EQ(same.of_bound, first.of_bound);
  EXPECT_LT(same.rays_spent, first.rays / 4) << "viewpoints are tested, no ray is cast";

  again.misses = first.misses + 1;  // those of before count, whatever the set has now
  const finish_result longer = finish_with_rays(w.rays, w.neighbors, room_middle, how, set);
  EXPECT_TRUE(longer.bound_met);
  EXPECT_EQ(longer.of_bound.number, first.of_bound.number) << "one more miss: further rays of the same batch";
  EXPECT_EQ(longer.misses, again.misses);
  EXPECT_GT(longer.rays, first.rays);
  EXPECT_GT(longer.of_bound.parts.size(), first.of_bound.parts.size());
  EXPECT_LE(longer.upper_bound, how.max_pixel_error);

  again.misses = 64;
  const finish_result other = finish_with_rays(w.rays, w.neighbors, room_middle, how, set);
  EXPECT_TRUE(other.bound_met);
  EXPECT_EQ(other.of_bound.number, first.of_bound.number + 1);
  EXPECT_GT(other.confidence, first.confidence) << "a part of it is spent";

  again.misses = first.misses;
  cell_set lacking(w.s.polygon_count);
  std::vector<triangle> all;  // each ray passes one
  for (std::uint32_t polygon = 0; polygon < w.s.polygon_count; ++polygon)
    all.push_back(corners_of(w.geometry, polygon));
  const triangle_tree edited_room(all, 0.002f);
  again.edited = &edited_room;
  const finish_result edited = finish_with_rays(w.rays, w.neighbors, room_middle, how, lacking);
  EXPECT_TRUE(edited.bound_met);
  EXPECT_GT(edited.of_bound.number, first.of_bound.number) << "all rays miss in a set of nothing";
  EXPECT_EQ(lacking.size(), w.s.polygon_count);
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

// A room of 10,800 polygons. Hemicubes of 16 pixels and what a round costs leave too few rays for a batch that proves
// the target.
struct fine_room {
  scene_with_rays w{gridded_room(30)};
  std::unique_ptr<hemicube_source> source = make_rays_source(w.rays, {.resolution = 16, .far_plane = 10.0f});
  std::uint32_t hemicubes = 0;  // of the last call

  finish_result finish(std::uint32_t further_rounds, std::uint64_t max_rays) {
    cell_set set(w.s.polygon_count);
    search_views views{guided_views(w.rays, room_middle, {.resolution = 16}), *source};
    const finish_result result = finish_with_rays(
        w.rays, w.neighbors, room_middle,
        {.max_pixel_error = 1e-3, .max_rays = max_rays, .further_rounds = further_rounds}, set, &views);
    hemicubes = views.poses.taken();
    return result;
  }
};

TEST(certify, takes_another_round_where_the_rays_do_not_suffice) {
  fine_room room;
  constexpr std::uint64_t max_rays = 14'000;
  const finish_result one = room.finish(0, max_rays);
  const std::uint32_t of_one = room.hemicubes;
  EXPECT_FALSE(one.bound_met);
  EXPECT_EQ(one.rounds, 1u);

  const finish_result more = room.finish(3, max_rays);
  EXPECT_TRUE(more.bound_met);
  EXPECT_LE(more.upper_bound, 1e-3);
  EXPECT_EQ(more.rounds, 2u);
  EXPECT_GE(room.hemicubes, 2 * of_one) << "it begins with hemicubes";
  // The batches of all rounds share the 5 %, so the last one has what the others left.
  EXPECT_GT(more.batches, one.batches);
  EXPECT_GE(more.confidence, 1.0 - 0.05 / std::ldexp(1.0, static_cast<int>(more.batches)));

  const finish_result again = room.finish(3, max_rays);
  EXPECT_EQ(again.rays, more.rays);
  EXPECT_EQ(again.rays_spent, more.rays_spent);
}

TEST(certify, takes_no_round_that_cannot_prove_the_target) {
  fine_room room;
  const finish_result result = room.finish(3, 5'000);  // the second batch takes more, even without misses
  EXPECT_FALSE(result.bound_met);
  EXPECT_EQ(result.rounds, 1u);
}

// The second batch has a single ray left, whose bound is about 1.
TEST(certify, keeps_the_smallest_bound) {
  fine_room room;
  const finish_result result = room.finish(0, 16'000);
  EXPECT_EQ(result.batches, 2u);
  EXPECT_LT(result.upper_bound, 0.02);
}

// A room with single triangles in the air, `size` or twice as wide and far from each other: each is found alone.
tiny_scene dusty_room(int triangles, float size) {
  tiny_scene tiny = gridded_room(1);
  constexpr float golden_angle = 2.39996323f;
  for (int i = 0; i < triangles; ++i) {
    const float y = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(triangles);
    const float around = std::sqrt(1.0f - y * y), turn = golden_angle * static_cast<float>(i);
    const glm::vec3 out(around * std::cos(turn), y, around * std::sin(turn));
    const glm::vec3 side = glm::normalize(glm::cross(out, glm::vec3(0.3f, 0.5f, 0.8f))), up = glm::cross(side, out);
    const float width = size * static_cast<float>(1 + i % 2), away = 1.1f + 0.2f * static_cast<float>(i % 4);
    tiny.triangle(away * out, away * out + width * side, away * out + width * up);
  }
  return tiny;
}

// Batches that end early would each find a few of the triangles, with half of the risk of the one before.
TEST(certify, many_single_misses_do_not_use_up_the_risk) {
  const scene_with_rays w(dusty_room(2'000, 0.006f));
  cell_set set(w.s.polygon_count);
  const finish_result result = finish_with_rays(w.rays, w.neighbors, room_middle, {.max_pixel_error = 3e-4}, set);
  EXPECT_TRUE(result.bound_met);
  EXPECT_LT(result.batches, 20u);
}

// Only 1 in 500 viewpoints is in the room with triangles: hemicubes at even distances next to never are.
TEST(certify, renders_cubes_where_rays_missed) {
  tiny_scene tiny = dusty_room(1'000, 0.08f);
  tiny.closed_box({-2, -2, -2}, {2, 2, 2});
  tiny.closed_box({-17, -17, -17}, {17, 17, 17}, true);
  const scene_with_rays w(std::move(tiny));
  const box everywhere{{-16, -16, -16}, {16, 16, 16}};
  const auto source = make_rays_source(w.rays, {.resolution = 64, .far_plane = 100.0f});
  search_views views{guided_views(w.rays, everywhere, {.geometry_inside = true, .resolution = 64}), *source};
  cell_set set(w.s.polygon_count);
  const finish_result result =
      finish_with_rays(w.rays, w.neighbors, everywhere, {.max_pixel_error = 3e-5, .max_rays = 20'000'000}, set, &views);
  EXPECT_TRUE(result.bound_met);
  EXPECT_LT(views.poses.taken(), 200u) << "24,576 without cubes where rays missed";
}

// Between the boxes most polygons are visible from a few viewpoints alone.
TEST(certify, looks_beside_members_before_another_long_batch) {
  tiny_scene tiny = gridded_room(40);
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z)
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2) {
          const glm::vec3 center = 0.68f * glm::vec3(x, y, z), size(0.15f);
          tiny.closed_box(center - size, center + size);
        }
  const scene_with_rays w(std::move(tiny));
  const auto source = make_rays_source(w.rays, {.resolution = 16, .far_plane = 10.0f});
  search_views views{guided_views(w.rays, room_middle, {.resolution = 16}), *source};
  cell_set set(w.s.polygon_count);
  const finish_result result =
      finish_with_rays(w.rays, w.neighbors, room_middle, {.max_pixel_error = 1e-3}, set, &views);
  EXPECT_TRUE(result.bound_met);
  EXPECT_LT(result.rays_spent, 110'000u) << "169,661 without these rays";
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
