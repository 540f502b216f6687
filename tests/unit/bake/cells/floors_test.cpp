#include "cells/floors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "unit/bake/tiny_scene.h"

namespace {

using namespace sightcell;
using bake::cell_floor;
using bake::view_cell;

// A cell of 4 x 2 x 4 m over a floor.
view_cell cell_over(int x, int z, double floor) {
  view_cell cell;
  cell.min = {4.0f * static_cast<float>(x), static_cast<float>(floor), 4.0f * static_cast<float>(z)};
  cell.max = cell.min + glm::vec3{4.0f, 2.0f, 4.0f};
  cell.floor = floor;
  cell.floor_area = 16.0;
  return cell;
}

void add_storey(std::vector<view_cell>& cells, int first_x, int side, double floor) {
  for (int z = 0; z < side; ++z)
    for (int x = first_x; x < first_x + side; ++x) cells.push_back(cell_over(x, z, floor));
}

std::size_t count_of(const std::vector<cell_floor>& floors) {
  std::vector<std::uint32_t> all;
  for (const cell_floor& floor : floors) all.insert(all.end(), floor.cells.begin(), floor.cells.end());
  std::sort(all.begin(), all.end());
  return static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
}

TEST(floors, stairs_end_at_a_storey) {
  std::vector<view_cell> cells;
  add_storey(cells, 0, 4, 4.0);  // the upper storey comes first in the list, and last in the floors
  add_storey(cells, 0, 4, 0.0);
  for (int step = 0; step < 3; ++step) cells.push_back(cell_over(4, step, 1.0 + step));  // beside both
  const std::vector<cell_floor> floors = bake::find_floors(cells, 12);
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_EQ(count_of(floors), cells.size());
  EXPECT_EQ(floors[0].lowest, 0.0);
  EXPECT_LE(floors[0].highest, 3.0);
  EXPECT_EQ(floors[1].highest, 4.0);
  EXPECT_EQ(std::count_if(floors[1].cells.begin(), floors[1].cells.end(), [](auto cell) { return cell < 16; }), 16);
}

TEST(floors, a_slope_is_one_floor) {
  std::vector<view_cell> cells;
  for (int x = 0; x < 30; ++x)
    for (int z = 0; z < 3; ++z)
      for (const double above : {0.0, 2.0}) cells.push_back(cell_over(x, z, 3.0 * x + above));
  const std::vector<cell_floor> floors = bake::find_floors(cells, 12);
  ASSERT_EQ(floors.size(), 1u);
  EXPECT_EQ(floors[0].cells.size(), cells.size());
  EXPECT_EQ(floors[0].highest, 89.0);
}

TEST(floors, buildings_beside_each_other_are_one_floor) {
  std::vector<view_cell> cells;
  add_storey(cells, 0, 4, 0.0);
  add_storey(cells, 20, 4, 11.0);
  EXPECT_EQ(bake::find_floors(cells, 12).size(), 1u);
}

TEST(floors, storeys_beyond_the_limit_are_joined) {
  std::vector<view_cell> cells;
  for (int storey = 0; storey < 7; ++storey) add_storey(cells, 0, 4, 4.0 * storey);
  EXPECT_EQ(bake::find_floors(cells, 12).size(), 7u);
  const std::vector<cell_floor> floors = bake::find_floors(cells, 3);
  EXPECT_EQ(floors.size(), 3u);
  EXPECT_EQ(count_of(floors), cells.size());
}

TEST(floors, layers_of_a_grid_are_floors) {
  std::vector<view_cell> cells;
  for (int layer = 0; layer < 3; ++layer) add_storey(cells, 0, 4, 2.0 * layer);
  for (view_cell& cell : cells) cell.floor_area = 0.0;
  EXPECT_EQ(bake::find_floors(cells, 12).size(), 3u);
}

TEST(floors, a_few_cells_are_no_floor) {
  std::vector<view_cell> cells;
  add_storey(cells, 0, 6, 0.0);
  cells.push_back(cell_over(2, 2, 5.0));
  EXPECT_EQ(bake::find_floors(cells, 12).size(), 1u);
  EXPECT_TRUE(bake::find_floors({}, 12).empty());
}

// Cells of a scene know the floor below them: also where one storey's eyes are in the cells of the storey above.
TEST(floors, of_a_house_with_two_storeys) {
  test::tiny_scene scene;
  scene.quad({-16, 0, -16}, {-16, 0, 16}, {16, 0, 16}, {16, 0, -16});
  scene.closed_box({-16, 2.7f, -16}, {16, 3, 16});
  const scene::scene s = scene.finished();
  bake::settings how;
  how.reach = bake::reach_kind::everywhere;
  const bake::cell_list list = bake::make_cells(scene::flatten(s), how);
  const std::vector<cell_floor> floors = bake::find_floors(list.cells, 12);
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_NEAR(floors[0].highest, 0.0, 0.11);
  EXPECT_NEAR(floors[1].lowest, 3.0, 0.11);
  EXPECT_NEAR(floors[1].highest, 3.0, 0.11);
}

}  // namespace
