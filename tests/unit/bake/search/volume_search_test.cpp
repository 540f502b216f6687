// Which volumes a cell sees, against what is seen in truth.
#include "search/volume_search.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "bound/verification_rays.h"
#include "search/certify.h"
#include "trace/viewpoints.h"
#include "unit/bake/two_rooms.h"

namespace sightcell::bake {
namespace {

// The corner of the left room, and both rooms, where volumes are.
const box corner{{-5, 1, -5}, {-4, 2, -4}};

struct rooms {
  scene::scene s = test::two_rooms();
  scene::world_geometry geometry = scene::flatten(s);
  ray_scene rays{geometry, false};
  near_polygons neighbors{rays};
  volume_grid grid;

  explicit rooms(double width) : grid(both(), width, 0.25) {}

  static std::vector<view_cell> both() {
    view_cell left, right;
    left.min = {-5.5f, 0.5f, -5.5f}, left.max = {-0.5f, 2.5f, 5.5f};
    right.min = {0.5f, 0.5f, -5.5f}, right.max = {5.5f, 2.5f, 5.5f};
    return {left, right};
  }
  std::uint32_t at(const glm::vec3& point) const {
    const glm::dvec3 place = glm::floor(glm::dvec3(point) / grid.width());
    return grid.at({static_cast<int>(place.x), static_cast<int>(place.y), static_cast<int>(place.z)});
  }
  cell_set finished(double target, int threads = 2) const {
    cell_set set(s.polygon_count, nullptr, s.polygon_count, grid.count());
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const finish_result proof = finish_with_rays(
          rays, neighbors, corner, {.max_pixel_error = target, .seed = 1, .place = 7, .volumes = &grid}, set);
      EXPECT_TRUE(proof.bound_met);
      EXPECT_LE(proof.upper_bound, target);
    });
    return set;
  }
};

TEST(volume_search, sees_through_a_door_and_not_through_a_wall) {
  const rooms r(1.0);
  const cell_set set = r.finished(1e-3);
  const auto sees = [&](const glm::vec3& point) { return set.volumes().contains(r.at(point)); };
  EXPECT_TRUE(sees({-4.5f, 1.5f, -4.5f})) << "the cell itself";
  EXPECT_TRUE(sees({-1.5f, 0.5f, 4.5f})) << "the same room";
  EXPECT_TRUE(sees({1.5f, 0.5f, 1.5f})) << "through the door";
  EXPECT_TRUE(sees({4.5f, 0.5f, 4.5f}));
  for (const glm::vec3& hidden : {glm::vec3(1.5f, 0.5f, -4.5f), glm::vec3(1.5f, 0.5f, 5.5f),
                                  glm::vec3(4.5f, 1.5f, -3.5f), glm::vec3(0.5f, 0.5f, -2.5f)})
    EXPECT_FALSE(sees(hidden)) << hidden.x << " " << hidden.z;
  EXPECT_FALSE(sees({-3.5f, -0.5f, -3.5f})) << "under the floor";
}

// Whoever has a clear line from an eye to a point has its volume in the set.
TEST(volume_search, what_it_lacks_is_within_the_bound) {
  const rooms r(0.5);
  const double target = 1e-3;
  const cell_set set = r.finished(target);
  random_stream random(5, 5, purpose::verify);
  std::uint64_t tries = 2048;
  const auto eyes = draw_viewpoints(r.rays, corner, 0.05f, 200, tries, random, tries);
  int clear = 0, lacking = 0;
  sight seen;
  for (int i = 0; i < 200'000; ++i) {
    const glm::vec3 eye = eyes[random.bits() % eyes.size()], point = random.in_box({-6, 0, -6}, {6, 3, 6});
    const float length = glm::distance(eye, point);
    r.rays.trace(eye, (point - eye) / length, seen);
    if (!(length > 0.0f) || seen.distance < length) continue;
    const std::uint32_t volume = r.at(point);
    if (volume == volume_grid::none) continue;
    ++clear;
    if (!set.volumes().contains(volume)) ++lacking;
  }
  EXPECT_GT(clear, 20'000);
  EXPECT_LE(lacking, 10.0 * target * clear) << "points are spread over space, rays over directions";
  // By rays it is the bound itself, and by the other way of walking through the lattice.
  const grid_trial trial(r.grid, set.volumes());
  const visibility_rules rules{.volumes = &trial};
  const verification_batch batch = cast_verification_rays(r.rays, corner, rules, 100'000, {9, 9, purpose::verify},
                                            [&](std::uint32_t p) { return set.contains(p); });
  EXPECT_LE(batch.misses, 1.3 * target * 100'000);
  EXPECT_LE(batch.misses_of_volumes, batch.misses);
}

TEST(volume_search, never_adds_what_is_not_seen) {
  const rooms r(0.5);
  const cell_set set = r.finished(1e-3);
  // Each member has a line to it from somewhere in the cell, or touches it.
  random_stream random(6, 6, purpose::verify);
  const auto touching = r.grid.touching(corner);
  int unseen = 0;
  for (const std::uint32_t volume : set.volumes().members()) {
    if (std::binary_search(touching.begin(), touching.end(), volume)) continue;
    const box where = r.grid.box_of(volume);
    bool seen_once = false;
    sight seen;
    for (int i = 0; i < 20'000 && !seen_once; ++i) {
      const glm::vec3 eye = random.in_box(corner.min, corner.max), point = random.in_box(where.min, where.max);
      r.rays.trace(eye, glm::normalize(point - eye), seen);
      seen_once = seen.distance >= glm::distance(eye, point);
    }
    if (!seen_once) ++unseen;
  }
  EXPECT_LE(unseen, 2) << "those of which next to nothing is seen";
}

TEST(volume_search, does_not_depend_on_threads) {
  const rooms r(0.5);
  const cell_set one = r.finished(1e-3, 1), four = r.finished(1e-3, 4);
  EXPECT_EQ(one.volumes().members(), four.volumes().members());
  EXPECT_GT(one.volumes().members().size(), 100u);
}

TEST(volume_search, what_touches_the_cell_is_seen_before_any_ray) {
  const rooms r(1.0);
  cell_set set(r.s.polygon_count, nullptr, r.s.polygon_count, r.grid.count());
  const box low{{-5, 0, -5}, {-4, 1, -4}};
  const volume_search search(r.rays, r.grid, low, {.seed = 1, .place = 1}, set);
  EXPECT_EQ(set.volumes().members(), r.grid.touching(low));
  EXPECT_TRUE(set.volumes().contains(r.at({-4.5f, -0.5f, -4.5f}))) << "also under its floor";
}

TEST(volume_search, looks_through_no_crack) {
  // Two halves of a wall, 1 mm apart: all behind it is hidden by rule 3, and seen where rule 3 is off.
  test::tiny_scene tiny;
  const test::tiny_scene::look sheet{scene::alpha_mode::opaque, true};
  tiny.quad({0, -9, -9}, {0, -9, -0.0005f}, {0, 9, -0.0005f}, {0, 9, -9}, sheet);
  tiny.quad({0, -9, 0.0005f}, {0, -9, 9}, {0, 9, 9}, {0, 9, 0.0005f}, sheet);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  view_cell all;
  all.min = {-4, 0, -4}, all.max = {4, 2, 4};
  const volume_grid grid({&all, 1}, 1.0, 0.25);
  const box before{{-2, 0, -1}, {-1, 1, 1}};
  const glm::vec3 eye{-1.5f, 0.5f, 0.0f};
  for (const float gap : {0.0f, 0.002f}) {
    cell_set set(s.polygon_count, nullptr, s.polygon_count, grid.count());
    const grid_trial trial(grid, set.volumes());
    std::vector<passed_volume> passed;
    trial.lacking({eye, {1, 0, 0}}, std::numeric_limits<double>::infinity(), passed);
    ASSERT_GT(passed.size(), 4u);
    drop_behind_gaps(rays, {eye, {1, 0, 0}}, gap, passed);
    const bool behind = std::any_of(passed.begin(), passed.end(),
                                    [&](const passed_volume& p) { return grid.places()[p.volume].x > 0; });
    EXPECT_EQ(behind, gap == 0.0f);
    EXPECT_FALSE(passed.empty());
  }
  cell_set set(s.polygon_count, nullptr, s.polygon_count, grid.count());
  volume_search search(rays, grid, before, {.seed = 1, .place = 1, .smallest_gap = 0.002f}, set);
  search.look_for(1e-6);
  for (const std::uint32_t volume : set.volumes().members()) EXPECT_LE(grid.places()[volume].x, 0);
}

TEST(volume_search, a_ray_that_leaves_the_scene_sees_all_on_its_way) {
  test::tiny_scene tiny;
  tiny.quad({-40, 0, 40}, {40, 0, 40}, {40, 0, -40}, {-40, 0, -40});  // ground under an open sky
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  view_cell all;
  all.min = {-20, 0, -20}, all.max = {20, 2, 20};
  const volume_grid grid({&all, 1}, 2.0, 0.25);
  const box where{{-1, 1, -1}, {1, 2, 1}};
  cell_set set(s.polygon_count, nullptr, s.polygon_count, grid.count());
  const grid_trial trial(grid, set.volumes());
  const visibility_rules rules{.volumes = &trial};
  const auto lacking = [&] {
    return cast_verification_rays(rays, where, rules, 20'000, {9, 9, purpose::verify}, [](std::uint32_t) { return true; });
  };
  EXPECT_EQ(lacking().misses, 20'000u) << "all, up and down";
  volume_search search(rays, grid, where, {.seed = 1, .place = 1}, set);
  search.look_for(1e-5);
  EXPECT_LT(lacking().misses, 40u);
  for (std::uint32_t volume = 0; volume < grid.count(); ++volume)
    EXPECT_EQ(set.volumes().contains(volume), grid.places()[volume].y >= 0) << "over the ground and not under it";
}

TEST(volume_search, a_lacking_volume_makes_a_ray_wrong) {
  const rooms r(1.0);
  cell_set set(r.s.polygon_count, nullptr, r.s.polygon_count, r.grid.count());
  for (std::uint32_t p = 0; p < r.s.polygon_count; ++p) set.add(p, {});
  for (std::uint32_t v = 0; v < r.grid.count(); ++v) set.volumes().add(v);
  const grid_trial trial(r.grid, set.volumes());
  const auto misses = [&](const volume_trial* volumes) {
    return cast_verification_rays(r.rays, corner, {.volumes = volumes}, 20'000, {9, 9, purpose::verify},
                           [&](std::uint32_t p) { return set.contains(p); });
  };
  EXPECT_EQ(misses(&trial).misses, 0u);
  // One of 1 m, 3 m away and in plain sight.
  const std::uint32_t gone = r.at({-1.5f, 1.5f, -1.5f});
  volume_set all_but(r.grid.count());
  for (std::uint32_t v = 0; v < r.grid.count(); ++v)
    if (v != gone) all_but.add(v);
  const grid_trial lacks_one(r.grid, all_but);
  const verification_batch batch = misses(&lacks_one);
  EXPECT_NEAR(static_cast<double>(batch.misses) / 20'000, 1.5 / (14.0 * 4.0 * 3.14), 0.005);
  EXPECT_EQ(batch.misses_of_volumes, batch.misses);
  ASSERT_EQ(batch.missed_volumes.size(), batch.misses);
  for (const found_volume& f : batch.missed_volumes) EXPECT_EQ(f.volume, gone);
  EXPECT_TRUE(batch.missed.empty());
}

}  // namespace
}  // namespace sightcell::bake
