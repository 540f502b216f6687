#include "cells/floor_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sightcell::bake {
namespace {

std::vector<floor_cell> cells_of(std::vector<eye_layers> eyes, const lattice_position& column = {.z = 2, .x = -7}) {
  std::vector<floor_cell> cells;
  add_floor_cells(eyes, column, cells);
  return cells;
}

TEST(floor_cells, eyes_that_overlap_are_in_one_cell) {
  const auto cells = cells_of({{9, 12, 2.0}, {0, 4, 1.0}, {3, 6, 1.5}, {6, 8, 4.0}});
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells[0].position, (lattice_position{.z = 2, .y = 0, .x = -7, .layers = 6}));
  EXPECT_EQ(cells[0].area, 2.5);
  EXPECT_EQ(cells[1].position.y, 6) << "touching is not overlapping";
  EXPECT_EQ(cells[2].position.y, 9);
  EXPECT_TRUE(cells_of({}).empty());
}

TEST(floor_cells, what_is_higher_than_wide_is_cut) {
  const auto cells = cells_of({{0, 6, 6.0}, {5, 11, 1.0}, {10, 17, 7.0}});
  ASSERT_EQ(cells.size(), 3u);
  std::int64_t at = 0;
  double area = 0.0;
  for (const floor_cell& cell : cells) {
    EXPECT_EQ(cell.position.y, at);
    EXPECT_LE(cell.position.layers, 8);
    at += cell.position.layers;
    area += cell.area;
  }
  EXPECT_EQ(at, 17);
  EXPECT_NEAR(area, 14.0, 1e-12);
  EXPECT_NEAR(cells[0].area, 5.0, 1e-12) << "five of the six layers of the first floor's eyes";
  EXPECT_EQ(cells_of({{0, 16, 1.0}}, {.level = 1}).size(), 1u) << "a wider cell may be higher";
}

TEST(floor_cells, the_order_of_eyes_does_not_matter) {
  std::vector<eye_layers> eyes{{0, 4, 0.1}, {2, 6, 0.7}, {2, 6, 0.3}, {11, 20, 0.9}};
  const auto cells = cells_of(eyes);
  std::reverse(eyes.begin(), eyes.end());
  const auto again = cells_of(eyes);
  ASSERT_EQ(again.size(), cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(again[i].position, cells[i].position);
    EXPECT_EQ(again[i].area, cells[i].area);
  }
}

TEST(floor_cells, wider_ones_contain_those_that_were_too_many) {
  std::vector<floor_cell> cells{{{.z = -1, .y = -3, .x = -2, .layers = 3}, 1.0},
                                {{.z = -1, .y = -1, .x = -1, .layers = 4}, 2.0},
                                {{.z = -1, .y = 0, .x = 0, .layers = 4}, 4.0},
                                {{.z = -1, .y = 9, .x = 1, .layers = 1}, 8.0}};
  const lattice on = widen_until(cells, lattice::over_floors(4.0), 3);
  EXPECT_EQ(on.width(), 8.0);
  EXPECT_EQ(on.height(), 1.0);
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells[0].position, (lattice_position{.z = -1, .y = -2, .x = -1, .layers = 4}));
  EXPECT_EQ(cells[0].area, 3.0);
  EXPECT_EQ(cells[1].position, (lattice_position{.z = -1, .y = 0, .x = 0, .layers = 2}));
  EXPECT_EQ(cells[2].position, (lattice_position{.z = -1, .y = 4, .x = 0, .layers = 1}));
}

}  // namespace
}  // namespace sightcell::bake
