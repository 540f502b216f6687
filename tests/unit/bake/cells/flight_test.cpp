// Cells without a floor: in boxes, near paths, and the boxes of the scene.
#include "cells/flight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cells/view_cell.h"
#include "errors/error_id.h"

namespace sightcell::bake {
namespace {

// A floor of 16 x 16 m at height 0; a player's eyes are in the two layers from 0 to 4 m.
scene::world_geometry floor_16() {
  scene::world_geometry g;
  g.positions = {{0, 0, 0}, {0, 0, 16}, {16, 0, 16}, {16, 0, 0}};
  g.indices = {0, 1, 2, 0, 2, 3};
  g.kinds.resize(2);
  g.min = {0, 0, 0};
  g.max = {16, 0, 16};
  return g;
}

settings no_floors() {
  settings how;
  how.reach = reach_kind::none;
  return how;
}

bool has(const cell_list& list, glm::vec3 low) {
  return std::any_of(list.cells.begin(), list.cells.end(), [&](const view_cell& cell) { return cell.min == low; });
}

TEST(flight, a_box_is_filled_with_the_lattice) {
  settings how = no_floors();
  how.fly = {{0, 0, 0, 8, 8, 8}};
  const cell_list list = make_cells(floor_16(), how);
  EXPECT_EQ(list.cells.size(), 2u * 4u * 2u);
  EXPECT_EQ(list.how, "16 cells of 4 m in 1 box of --fly");
  EXPECT_TRUE(list.warnings.empty());
  for (const float y : {0.0f, 2.0f, 4.0f, 6.0f}) EXPECT_TRUE(has(list, {4, y, 4})) << y;
  // A box that reaches a bit further takes one more layer, and one that touches it does not.
  how.fly = {{0, 0, 0, 8, 8.01f, 8}, {8, 0, 0, 12, 2, 4}};
  const cell_list both = make_cells(floor_16(), how);
  EXPECT_EQ(both.cells.size(), 2u * 5u * 2u + 1u);
  EXPECT_EQ(both.how, "21 cells of 4 m in 2 boxes of --fly");
}

TEST(flight, boxes_add_to_floors_and_share_their_lattice) {
  settings how;
  const std::size_t floors = make_cells(floor_16(), how).cells.size();
  how.fly = {{0, 0, 0, 8, 10, 8}, {0, 0, 0, 4, 10, 4}};
  const cell_list list = make_cells(floor_16(), how);
  const std::size_t shared = floors / 4;  // of a quarter of the floor
  EXPECT_EQ(list.cells.size(), floors + 2 * 5 * 2 - shared);
  EXPECT_TRUE(list.can_merge);
  EXPECT_TRUE(std::is_sorted(list.cells.begin(), list.cells.end(),
                             [](const view_cell& a, const view_cell& b) { return a.position < b.position; }));
  for (const view_cell& cell : list.cells)
    if (cell.min.x < 8 && cell.min.z < 8) {
      EXPECT_EQ(cell.floor_area, 16.0);
    }
  EXPECT_NE(list.how.find("over floors reached from"), std::string::npos) << list.how;
  EXPECT_TRUE(list.how.ends_with(", in 2 boxes of --fly")) << list.how;
}

TEST(flight, where_no_floor_is_the_boxes_remain) {
  scene::world_geometry g = floor_16();
  g.indices = {0, 2, 1, 0, 3, 2};  // a ceiling
  settings how;
  how.fly = {{0, 0, 0, 4, 2, 4}};
  const cell_list list = make_cells(g, how);
  EXPECT_EQ(list.cells.size(), 1u);
  EXPECT_EQ(list.warnings, std::vector<std::string>{"no floor with head room was found"});
}

TEST(flight, cells_near_a_path_are_those_whose_grown_boxes_it_meets) {
  settings how = no_floors();
  how.paths = {{{1, 1, 2}, {15, 1, 2}}};
  EXPECT_EQ(make_cells(floor_16(), how).cells.size(), 4u);
  how.paths = {{{0.25f, 1, 2}, {15, 1, 2}}};
  const cell_list list = make_cells(floor_16(), how);
  EXPECT_EQ(list.cells.size(), 5u) << "its start is less than half a meter from the cell before";
  EXPECT_TRUE(has(list, {-4, 0, 0}));
  EXPECT_EQ(list.how, "5 cells of 4 m within 0.5 m of 1 path");
  how.path_radius = 1.5f;
  EXPECT_EQ(make_cells(floor_16(), how).cells.size(), 6u * 3u) << "and the layers above and below";
  how.paths = {{{2, 1, 2}}};
  how.path_radius = 0.0f;
  EXPECT_EQ(make_cells(floor_16(), how).cells.size(), 1u) << "a point";
}

// The box around a diagonal of 8 x 8 cells has 64 cells, and the diagonal meets 15 or fewer.
TEST(flight, a_diagonal_has_the_cells_along_it) {
  settings how = no_floors();
  how.path_radius = 0.1f;
  how.paths = {{{0.5f, 1, 1.5f}, {30.5f, 1, 31.5f}}};
  const cell_list list = make_cells(floor_16(), how);
  EXPECT_EQ(list.cells.size(), 8u + 7u);
  for (int i = 0; i < 8; ++i)
    EXPECT_TRUE(has(list, {4.0f * static_cast<float>(i), 0, 4.0f * static_cast<float>(i)})) << i;
}

TEST(flight, what_is_outside_of_the_scene_is_a_warning) {
  settings how = no_floors();
  how.fly = {{20, 0, 0, 24, 2, 4}, {0, 0, 0, 4, 2, 4}};
  how.paths = {{{100, 0, 0}, {101, 0, 0}}};
  const cell_list list = make_cells(floor_16(), how);
  ASSERT_EQ(list.warnings.size(), 2u);
  EXPECT_EQ(list.warnings[0],
            "the box 20,0,0,24,2,4 of --fly is outside of the scene, which is from (0, 0, 0) to (16, 0, 16)");
  EXPECT_EQ(list.warnings[1], "path 0 has no point in the bounding box of the scene");
}

TEST(flight, too_many_cells_are_refused_at_once) {
  settings how = no_floors();
  how.fly = {{-1e6f, -1e6f, -1e6f, 1e6f, 1e6f, 1e6f}};
  EXPECT_EQ(test::error_id([&] { (void)make_cells(floor_16(), how); }), "cells.too-many");
  how.fly.clear();
  how.paths = {{{-1e7f, 0, 0}, {1e7f, 0, 0}}};
  EXPECT_EQ(test::error_id([&] { (void)make_cells(floor_16(), how); }), "cells.too-many");
  how.paths = {{{0, 0, 0}, {1000, 0, 0}}};
  how.path_radius = 100.0f;
  how.cell_size = 0.25f;
  EXPECT_EQ(test::error_id([&] { (void)make_cells(floor_16(), how); }), "cells.too-many");
}

TEST(flight, cells_of_the_scene_replace_those_over_floors) {
  scene::world_geometry g = floor_16();
  g.cells = {{"hall", {0, 0, 0}, {3, 3, 3}}, {"", {1, 1, 1}, {9, 4, 9}}};
  const cell_list list = make_cells(g, {});
  ASSERT_EQ(list.cells.size(), 2u);
  EXPECT_EQ(list.cells[0].name, "hall");
  EXPECT_EQ(list.cells[1].max, glm::vec3(9, 4, 9));
  EXPECT_TRUE(list.of_scene);
  EXPECT_FALSE(list.can_merge || list.cells[0].on_lattice);
  EXPECT_EQ(list.how, "2 cells of the scene (extras.sightcell.cell), instead of cells over floors");
  settings how = no_floors();
  how.fly = {{0, 0, 0, 4, 2, 4}};
  const cell_list flown = make_cells(g, how);
  EXPECT_EQ(flown.cells.size(), 1u);
  EXPECT_FALSE(flown.of_scene);
  ASSERT_EQ(flown.warnings.size(), 1u);
  EXPECT_NE(flown.warnings[0].find("2 cells of the scene (extras.sightcell.cell) are left out"), std::string::npos);
  g.cells[1].max[1] = 1.0f;
  EXPECT_EQ(test::error_id([&] { (void)make_cells(g, {}); }), "cells.empty-box");
}

}  // namespace
}  // namespace sightcell::bake
