#include "search/refinement.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <vector>

#include "trace/triangle_math.h"
#include "unit/bake/cards_with_flaps.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::cards_with_flaps;
using test::gridded_room;
using test::scene_with_rays;
using test::tiny_scene;

TEST(refinement, spreads_over_a_room_from_one_polygon) {
  const scene_with_rays w(gridded_room(4));
  cell_set set(w.s.polygon_count);
  set.add(0, {0, 0, 0});
  refinement beside(w.rays, w.neighbors, {1, 1, 0.0f}, set);
  const std::uint64_t rays = beside.run(1e-6, 1'000'000);
  EXPECT_EQ(set.size(), w.s.polygon_count);
  EXPECT_LT(rays, 2u * w.s.polygon_count) << "each is seen at the first try";
  double covered = 0.0;
  for (std::uint32_t p = 0; p < w.s.polygon_count; ++p) covered += solid_angle(corners_of(w.geometry, p), {0, 0, 0});
  EXPECT_NEAR(covered, whole_sphere, 1e-3);
  EXPECT_TRUE(beside.done());
}

TEST(refinement, leaves_what_is_worth_less) {
  tiny_scene tiny;
  // A large wall, and beside it along its right edge a strip of 1 cm.
  const auto wall = tiny.quad({4, -2, -2}, {4, -2, 2}, {4, 2, 2}, {4, 2, -2});
  const auto strip = tiny.quad({4, -2, 2}, {4, -2, 2.01f}, {4, 2, 2.01f}, {4, 2, 2});
  const scene_with_rays w(tiny);
  cell_set set(w.s.polygon_count);
  set.add(wall, {0, 0, 0});
  refinement beside(w.rays, w.neighbors, {1, 1, 0.0f}, set);
  (void)beside.run(0.1, 1'000'000);
  EXPECT_TRUE(set.contains(wall + 1));
  EXPECT_FALSE(set.contains(strip) || set.contains(strip + 1)) << "1 cm in 4 m is less than 0.1 sr";
  EXPECT_FALSE(beside.done());
  (void)beside.run(1e-6, 1'000'000);
  EXPECT_TRUE(set.contains(strip) && set.contains(strip + 1));
}

TEST(refinement, never_adds_what_is_not_seen) {
  tiny_scene tiny;
  // The upper and the lower half of a wall share an edge; from the eye a screen hides all of the lower one.
  const auto upper = tiny.quad({4, 0, -2}, {4, 0, 2}, {4, 2, 2}, {4, 2, -2});
  const auto lower = tiny.quad({4, -2, -2}, {4, -2, 2}, {4, 0, 2}, {4, 0, -2});
  const auto screen = tiny.quad({3, -9, -9}, {3, -9, 9}, {3, 0.2f, 9}, {3, 0.2f, -9});
  const scene_with_rays w(tiny);
  const glm::vec3 eye{0, 0.5f, 0};
  ASSERT_TRUE(faces(w.rays, lower, eye));
  cell_set set(w.s.polygon_count);
  set.add(upper, eye);
  refinement beside(w.rays, w.neighbors, {1, 1, 0.0f}, set);
  (void)beside.run(1e-9, 1'000'000);
  EXPECT_TRUE(set.contains(upper + 1));
  EXPECT_FALSE(set.contains(lower) || set.contains(lower + 1)) << "hidden";
  EXPECT_TRUE(set.contains(screen) || set.contains(screen + 1)) << "it was hit on the way to the lower half";
  (void)beside.run(0.0, 1'000'000);
  EXPECT_TRUE(beside.done()) << "nobody tries forever";
}

TEST(refinement, tries_from_another_place_after_a_miss) {
  tiny_scene tiny;
  // As above, but over a low screen: from its witness the lower half is hidden, from a place above it is not.
  const auto upper = tiny.quad({4, 0, -2}, {4, 0, 2}, {4, 2, 2}, {4, 2, -2});
  const auto lower = tiny.quad({4, -2, -2}, {4, -2, 2}, {4, 0, 2}, {4, 0, -2});
  tiny.quad({1, -9, -9}, {1, -9, 9}, {1, 0.4f, 9}, {1, 0.4f, -9});
  const scene_with_rays w(tiny);
  const glm::vec3 eye{0, 0.5f, 0};
  const std::vector<glm::vec3> places{{0, 3, 0}};
  for (const bool other_places : {false, true}) {
    cell_set set(w.s.polygon_count);
    set.add(upper, eye);
    refinement beside(w.rays, w.neighbors, {.seed = 1, .place = 1, .viewpoints = other_places ? &places : nullptr},
                      set);
    (void)beside.run(1e-9, 1'000'000);
    EXPECT_EQ(set.contains(lower) && set.contains(lower + 1), other_places);
  }
}

TEST(refinement, goes_on_where_another_ended) {
  tiny_scene tiny;
  const auto upper = tiny.quad({4, 0, -2}, {4, 0, 2}, {4, 2, 2}, {4, 2, -2});
  tiny.quad({4, -2, -2}, {4, -2, 2}, {4, 0, 2}, {4, 0, -2});  // hidden by a low screen
  const auto screen = tiny.quad({1, -9, -9}, {1, -9, 9}, {1, 0.4f, 9}, {1, 0.4f, -9});
  const scene_with_rays w(tiny);
  const auto rays = [&](std::size_t known, double tried, double priority) {
    cell_set set(w.s.polygon_count);
    for (const auto polygon : {upper, upper + 1, screen, screen + 1}) set.add(polygon, {0, 0.5f, 0});
    refinement beside(w.rays, w.neighbors, {.seed = 1, .place = 1, .known = known, .tried = tried}, set);
    return beside.run(priority, 1'000'000);
  };
  const std::uint64_t coarse = rays(0, 0.0, 1e-3), fine = rays(0, 0.0, 1e-6);
  EXPECT_GT(coarse, 0u);
  EXPECT_GT(fine, coarse);
  EXPECT_EQ(rays(4, 1e-3, 1e-3), 0u);
  EXPECT_EQ(rays(4, 1e-3, 1e-6), fine - coarse);
  EXPECT_EQ(rays(4, 0.0, 1e-6), 0u);
  EXPECT_GT(rays(1, 1e-3, 1e-3), 0u) << "the others joined since";
}

// Returns the rays per flap that a search casts behind n x n cards until no try is left.
double rays_per_flap(int n, bool& rarely_hits) {
  const scene_with_rays w(cards_with_flaps(n));
  cell_set set(w.s.polygon_count);
  for (std::uint32_t p = 0; p < w.s.polygon_count; ++p)
    if (p % 3 < 2) set.add(p, {0, 0, 0});
  refinement beside(w.rays, w.neighbors, {.seed = 1, .place = 1}, set);
  const std::uint64_t rays = beside.run(0.0, 100'000'000);
  EXPECT_TRUE(beside.done());
  rarely_hits = beside.rarely_hits();
  return static_cast<double>(rays) / (n * n);
}

TEST(refinement, drops_what_missed_where_tries_rarely_hit) {
  bool few = true, many = false;
  const double with_few = rays_per_flap(10, few), with_many = rays_per_flap(50, many);
  EXPECT_FALSE(few) << "too few tries to judge";
  EXPECT_TRUE(many);
  EXPECT_LT(with_many, with_few / 2.0);
}

TEST(refinement, limits_the_priority_of_large_polygons) {
  tiny_scene tiny;
  const auto upper = tiny.quad({4, 0, -2}, {4, 0, 2}, {4, 2, 2}, {4, 2, -2});
  const auto lower = tiny.quad({4, -2, -2}, {4, -2, 2}, {4, 0, 2}, {4, 0, -2});
  const scene_with_rays w(tiny);
  cell_set set(w.s.polygon_count);
  set.add(upper, {0, 0.5f, 0});
  refinement beside(w.rays, w.neighbors, {.seed = 1, .place = 1, .largest_priority = 1e-4f}, set);
  EXPECT_EQ(beside.run(1e-2, 1'000'000), 0u);
  EXPECT_FALSE(set.contains(lower));
  EXPECT_GT(beside.run(1e-4, 1'000'000), 0u);
  EXPECT_TRUE(set.contains(lower));
}

TEST(refinement, aims_at_no_back) {
  tiny_scene tiny;
  const auto front = tiny.wall_x(2, -1, 3);
  const auto back = tiny.quad({2, 3, 3}, {2, 3, -3}, {2, 6, -3}, {2, 6, 3});  // shares the upper edge, turned away
  const scene_with_rays w(tiny);
  cell_set set(w.s.polygon_count);
  set.add(front, {0, 0, 0});
  set.add(front + 1, {0, 0, 0});
  refinement beside(w.rays, w.neighbors, {1, 1, 0.0f}, set);
  EXPECT_EQ(beside.run(1e-9, 1'000'000), 0u);
  EXPECT_FALSE(set.contains(back));
}

TEST(refinement, does_not_depend_on_threads) {
  const scene_with_rays w(gridded_room(12));
  const auto members = [&](int threads) {
    cell_set set(w.s.polygon_count);
    set.add(0, {0.1f, 0.2f, 0.3f});
    tbb::task_arena arena(threads);
    arena.execute([&] {
      refinement beside(w.rays, w.neighbors, {1, 1, 0.0f}, set);
      (void)beside.run(2e-3, 400);
    });
    return set.members();
  };
  const auto one = members(1);
  EXPECT_EQ(one, members(4));
  EXPECT_LT(one.size(), w.s.polygon_count) << "the rays were not enough for all";
}

}  // namespace
}  // namespace sightcell::bake
