// Walkable floors. Scenes are a few quads, one behavior each.
#include "cells/walkable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "cells/view_cell.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

// Adds a horizontal rectangle at height y; facing up unless told.
void add_floor(scene::world_geometry& g, float x0, float z0, float x1, float z1, float y, bool up = true,
               scene::polygon_kind kind = scene::polygon_kind()) {
  const auto base = static_cast<std::uint32_t>(g.positions.size());
  g.positions.insert(g.positions.end(), {{x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0}});
  const std::vector<std::uint32_t> corners =
      up ? std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3} : std::vector<std::uint32_t>{0, 2, 1, 0, 3, 2};
  for (const std::uint32_t c : corners) g.indices.push_back(base + c);
  g.kinds.insert(g.kinds.end(), 2, kind);
  if (kind.absent) return;
  const bool first = g.kinds.size() == 2;
  for (const glm::vec3 p : {glm::vec3(x0, y, z0), glm::vec3(x1, y, z1)}) {
    g.min = first && p.x == x0 ? p : glm::min(g.min, p);
    g.max = first && p.x == x0 ? p : glm::max(g.max, p);
  }
}

// Settings of cells around a standing eye over all floors.
settings standing() {
  settings how;
  how.reach = reach_kind::everywhere;
  how.player.lowest_eye = how.player.highest_eye = static_cast<float>(eye_height);
  return how;
}

cell_list cells_of(const scene::world_geometry& g, const settings& how = standing()) {
  return make_cells(g, how);
}

// Many small floors: a place with many polygons around it.
void add_tiles(scene::world_geometry& g, float x0, float z0, int count, float y) {
  for (int i = 0; i < count * count; ++i) {
    const float x = x0 + static_cast<float>(i % count), z = z0 + static_cast<float>(i / count);
    add_floor(g, x, z, x + 1.0f, z + 1.0f, y);
  }
}

bool holds(const view_cell& cell, glm::vec3 p) {
  return p.x >= cell.min.x && p.x < cell.max.x && p.y >= cell.min.y && p.y < cell.max.y && p.z >= cell.min.z &&
         p.z < cell.max.z;
}

bool any_holds(const cell_list& list, glm::vec3 p) {
  return std::any_of(list.cells.begin(), list.cells.end(), [&](const view_cell& c) { return holds(c, p); });
}

TEST(walkable, a_flat_floor_has_one_cell_per_column) {
  scene::world_geometry g;
  add_floor(g, 0.5f, 0.5f, 7.5f, 7.5f, 0.0f);
  const cell_list list = cells_of(g);
  ASSERT_EQ(list.cells.size(), 4u);
  for (const view_cell& c : list.cells) {
    EXPECT_EQ(c.min.y, 1.5f) << "half a meter is a layer, and the eyes are at 1.6 m";
    EXPECT_EQ(c.max.y, 2.0f);
    EXPECT_NEAR(c.floor_area, 12.25, 1.0);
  }
  EXPECT_TRUE(list.warnings.empty());
}

TEST(walkable, a_cell_is_as_high_as_the_eyes_over_a_slope) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 8.0f, 4.0f, 0.0f);
  for (glm::vec3& p : g.positions) p.y = 0.25f * p.x;
  g.max.y = 2.0f;
  const cell_list list = cells_of(g, settings());
  ASSERT_EQ(list.cells.size(), 2u);
  for (const view_cell& c : list.cells) {
    EXPECT_NEAR(c.min.y, 0.25f * c.min.x + 0.75f, 0.3f);
    EXPECT_NEAR(c.max.y, 0.25f * c.max.x + 2.35f, 0.3f);
  }
}

TEST(walkable, every_eye_over_the_floor_has_a_cell) {
  for (const float y : {-3.7f, -0.05f, 0.0f, 0.39f, 0.4f, 0.41f, 12.345f}) {
    scene::world_geometry g;
    add_floor(g, -5.0f, -3.0f, 6.0f, 2.0f, y);
    const cell_list list = cells_of(g);
    for (float x = -4.99f; x < 6.0f; x += 0.7f) EXPECT_TRUE(any_holds(list, {x, y + 1.6f, 0.3f})) << x << ' ' << y;
  }
}

TEST(walkable, order_is_z_y_x_and_repeats) {
  scene::world_geometry g;
  add_floor(g, -8.0f, -8.0f, 8.0f, 8.0f, 0.0f);
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 6.0f);
  const cell_list a = cells_of(g), b = cells_of(g);
  ASSERT_EQ(a.cells.size(), b.cells.size());
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    EXPECT_EQ(a.cells[i].place, b.cells[i].place);
    if (i == 0) continue;
    const glm::vec3 p = a.cells[i - 1].min, q = a.cells[i].min;
    EXPECT_TRUE(std::tie(p.z, p.y, p.x) < std::tie(q.z, q.y, q.x));
  }
}

// A wall of 3 m on a floor, and edges that end a voxel above the floor and above each other.
scene::world_geometry walled_floor() {
  scene::world_geometry g;
  add_floor(g, -8.0f, -8.0f, 8.0f, 8.0f, 0.0f);
  const auto add_wall = [&](float x, float low, float high) {
    const auto base = static_cast<std::uint32_t>(g.positions.size());
    g.positions.insert(g.positions.end(), {{x, low, -8.0f}, {x, low, 8.0f}, {x, high, 8.0f}, {x, high, -8.0f}});
    for (const std::uint32_t c : {0u, 1u, 2u, 0u, 2u, 3u}) g.indices.push_back(base + c);
    g.kinds.resize(g.kinds.size() + 2);
    g.max.y = std::max(g.max.y, high);
  };
  add_wall(0.1f, 0.0f, 3.0f);
  for (int i = 0; i < 20; ++i) add_wall(4.1f, 0.0f, 0.12f + 0.1f * static_cast<float>(i));
  return g;
}

scene::world_geometry reversed(scene::world_geometry g) {
  const std::vector<std::uint32_t> indices = g.indices;
  const std::size_t count = g.kinds.size();
  for (std::size_t p = 0; p < count; ++p)
    for (std::size_t k = 0; k < 3; ++k) g.indices[3 * p + k] = indices[3 * (count - 1 - p) + k];
  std::reverse(g.kinds.begin(), g.kinds.end());
  return g;
}

TEST(walkable, cells_do_not_depend_on_the_order_of_polygons) {
  const scene::world_geometry g = walled_floor();
  const cell_list one = cells_of(g), other = cells_of(reversed(g));
  ASSERT_EQ(one.cells.size(), other.cells.size());
  for (std::size_t i = 0; i < one.cells.size(); ++i) EXPECT_EQ(one.cells[i].place, other.cells[i].place) << i;
  for (const cell_list* cells : {&one, &other}) {
    EXPECT_TRUE(any_holds(*cells, {2.0f, eye_height, 0.0f}));
    EXPECT_FALSE(any_holds(*cells, {0.1f, 3.0f + eye_height, 0.0f})) << "a wall is no floor at its top";
    EXPECT_FALSE(any_holds(*cells, {4.1f, 2.0f + eye_height, 0.0f})) << "nor a pile of edges";
  }
}

TEST(walkable, low_ceiling_leaves_no_head_room) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 16.0f, 4.0f, 0.0f);
  add_floor(g, 8.0f, 0.0f, 16.0f, 4.0f, 1.5f, false);  // the ceiling faces down: no floor on top of it
  const cell_list list = cells_of(g);
  EXPECT_TRUE(any_holds(list, {2.0f, 1.6f, 2.0f}));
  EXPECT_FALSE(any_holds(list, {14.0f, 1.6f, 2.0f}));
  EXPECT_FALSE(any_holds(list, {14.0f, 3.1f, 2.0f}));
}

TEST(walkable, water_and_glass_are_neither_floor_nor_ceiling) {
  scene::world_geometry g;
  scene::polygon_kind blend;
  blend.alpha = scene::alpha_mode::blend;
  blend.double_sided = true;
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 0.0f);
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 1.0f, true, blend);
  const cell_list list = cells_of(g);
  EXPECT_TRUE(any_holds(list, {2.0f, 1.6f, 2.0f}));
  EXPECT_FALSE(any_holds(list, {2.0f, 2.6f, 2.0f}));
}

TEST(walkable, steep_slopes_are_no_floor) {
  for (const float rise : {3.9f, 4.2f}) {  // just below and just above 45 degrees over 4 m
    scene::world_geometry g;
    add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 0.0f);
    for (glm::vec3& p : g.positions) p.y = p.x > 2.0f ? rise : 0.0f;
    g.max.y = rise;
    EXPECT_EQ(cells_of(g).warnings.empty(), rise < 4.0f) << rise;
  }
}

TEST(walkable, back_of_a_floor_counts_only_when_double_sided) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 0.0f, false);
  EXPECT_NE(cells_of(g).how.find("grid"), std::string::npos);
  settings how = standing();
  how.all_double_sided = true;
  EXPECT_NE(cells_of(g, how).how.find("over floors"), std::string::npos);
  for (scene::polygon_kind& kind : g.kinds) kind.double_sided = true;
  EXPECT_NE(cells_of(g).how.find("over floors"), std::string::npos);
}

TEST(walkable, no_floor_gives_a_grid_and_says_so) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 0.0f, false);
  const cell_list list = cells_of(g);
  EXPECT_EQ(list.cells.size(), 3u * 2u * 3u);  // -2..6, -2..2, -2..6
  ASSERT_EQ(list.warnings.size(), 1u);
  EXPECT_NE(list.warnings[0].find("no floor"), std::string::npos);
}

TEST(walkable, degenerate_polygons_never_reach_the_field) {
  scene::world_geometry g;
  scene::polygon_kind broken;
  broken.absent = true;
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 0.0f);
  add_floor(g, NAN, 0.0f, INFINITY, 4.0f, 0.0f, true, broken);
  EXPECT_EQ(cells_of(g).cells.size(), 1u);
}

TEST(walkable, a_sky_dome_does_not_blur_a_level) {
  scene::world_geometry g;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i % 40), z = static_cast<float>(i / 40);
    add_floor(g, x, z, x + 1.0f, z + 1.0f, 0.0f);
  }
  add_floor(g, -5e4f, -5e4f, 5e4f, 5e4f, -5e4f);
  add_floor(g, -5e4f, -5e4f, 5e4f, 5e4f, 5e4f, false);
  const cell_list list = cells_of(g);
  EXPECT_TRUE(any_holds(list, {20.0f, 1.6f, 12.0f}));
  EXPECT_LT(list.cells.size(), 500u);
  ASSERT_EQ(list.warnings.size(), 1u);
  EXPECT_NE(list.warnings[0].find("around most polygons, at heights of -3 to 3 m"), std::string::npos);
}

TEST(walkable, more_than_most_cells_are_twice_as_wide_with_a_warning) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 64.0f, 64.0f, 0.0f);
  settings how;
  how.most_cells = 300;
  EXPECT_EQ(make_cells(g, how).cells.size(), 256u);
  EXPECT_TRUE(make_cells(g, how).warnings.empty());
  how.most_cells = 255;
  const cell_list list = make_cells(g, how);
  EXPECT_EQ(list.cells.size(), 64u);
  EXPECT_EQ(list.cells[0].max.x - list.cells[0].min.x, 8.0f);
  ASSERT_EQ(list.warnings.size(), 1u);
  EXPECT_EQ(list.warnings[0], "256 cells of 4 m would be more than --most-cells 255: the smallest cells are 8 m wide");
}

// Cells across the origin never become one.
TEST(walkable, wide_terrain_around_the_origin_has_at_most_the_fewest_most_cells) {
  scene::world_geometry g;
  add_floor(g, -2000.0f, -2000.0f, 2000.0f, 2000.0f, 0.0f);
  settings how;
  how.most_cells = 64;
  const cell_list list = make_cells(g, how);
  EXPECT_EQ(list.cells.size(), 64u);
  EXPECT_EQ(list.cells[0].max.x - list.cells[0].min.x, 512.0f);
}

TEST(walkable, eyes_from_crouching_to_jumping_have_cells) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 8.0f, 4.0f, 0.0f);
  add_floor(g, 4.0f, 0.0f, 8.0f, 4.0f, 1.9f, false);  // a ceiling
  const cell_list list = cells_of(g, settings());
  for (const float eye : {0.9f, 1.6f, 2.09f}) EXPECT_TRUE(any_holds(list, {2.0f, eye, 2.0f})) << eye;
  EXPECT_FALSE(any_holds(list, {2.0f, 4.1f, 2.0f}));
  EXPECT_FALSE(any_holds(list, {6.0f, 2.09f, 2.0f})) << "above the ceiling";
}

// A street and a roof 6 m above it, which nobody can climb.
scene::world_geometry street_and_roof() {
  scene::world_geometry g;
  add_tiles(g, 0.0f, 0.0f, 16, 0.0f);
  add_floor(g, 20.0f, 0.0f, 40.0f, 16.0f, 6.0f);
  return g;
}

TEST(walkable, roofs_that_nobody_reaches_have_no_cells) {
  const scene::world_geometry g = street_and_roof();
  const glm::vec3 in_the_street{8.0f, 1.6f, 8.0f}, on_the_roof{30.0f, 7.6f, 8.0f};
  const cell_list walked = cells_of(g, settings());
  EXPECT_TRUE(any_holds(walked, in_the_street));
  EXPECT_FALSE(any_holds(walked, on_the_roof));
  EXPECT_NE(walked.how.find("reached from the floor with the most polygons around it"), std::string::npos);
  settings how;
  how.reach = reach_kind::everywhere;
  EXPECT_TRUE(any_holds(cells_of(g, how), on_the_roof));
}

TEST(walkable, a_start_decides_which_floors_are_reached) {
  scene::world_geometry g = street_and_roof();
  const glm::vec3 in_the_street{8.0f, 1.6f, 8.0f}, on_the_roof{30.0f, 7.6f, 8.0f};
  settings how;
  how.starts = {{30.0f, 8.0f, 8.0f}};
  const cell_list list = cells_of(g, how);
  EXPECT_TRUE(any_holds(list, on_the_roof));
  EXPECT_FALSE(any_holds(list, in_the_street)) << "the gap between the two is wider than a jump";
  EXPECT_TRUE(list.warnings.empty());
  // Marked nodes of the scene are starts too; cameras only where there is no other, and only above a floor.
  g.starts = {{{30.0f, 8.0f, 8.0f}, false}, {{8.0f, 2.0f, 8.0f}, true}};
  EXPECT_TRUE(any_holds(cells_of(g, settings()), on_the_roof));
  EXPECT_FALSE(any_holds(cells_of(g, settings()), in_the_street));
  g.starts = {{{30.0f, 8.0f, 8.0f}, true}, {{8.0f, 200.0f, 8.0f}, true}};
  EXPECT_TRUE(any_holds(cells_of(g, settings()), on_the_roof));
  how.starts = {{-50.0f, 0.0f, 0.0f}};
  const cell_list nowhere = cells_of(g, how);
  ASSERT_EQ(nowhere.warnings.size(), 1u);
  EXPECT_NE(nowhere.warnings[0].find("no floor is within 8 m below the start (-50, 0, 0) m"), std::string::npos);
  EXPECT_TRUE(any_holds(nowhere, in_the_street)) << "a start without a floor is no start";
}

// A second floor that no way leads to belongs to a level if enough of the level's polygons are around it.
TEST(walkable, a_floor_with_many_polygons_around_it_is_a_start_too) {
  scene::world_geometry g = street_and_roof();
  add_tiles(g, 24.0f, 30.0f, 8, 9.0f);
  const cell_list list = cells_of(g, settings());
  EXPECT_TRUE(any_holds(list, {28.0f, 10.6f, 34.0f}));
  EXPECT_FALSE(any_holds(list, {30.0f, 7.6f, 8.0f}));
}

TEST(walkable, numbers_beyond_all_scenes_are_survived) {
  scene::world_geometry g;
  add_floor(g, 0.0f, 0.0f, 4.0f, 4.0f, 0.0f);
  add_floor(g, -1e30f, -1e30f, 1e30f, 1e30f, -1e30f);
  EXPECT_NO_THROW({
    try {
      cells_of(g);
    } catch (const error& e) {
      EXPECT_EQ(e.id(), "cells.too-far");
    }
  });
}

}  // namespace
}  // namespace sightcell::bake
