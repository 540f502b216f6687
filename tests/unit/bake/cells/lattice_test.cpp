#include "cells/lattice.h"

#include <gtest/gtest.h>

#include <set>

#include "cells/view_cell.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

TEST(grid, takes_every_cell_that_overlaps_the_box) {
  settings how;
  how.cells_grid = {{-1.0f, 0.0f, 0.0f, 4.0f, 2.5f, 4.0f}};
  const cell_list list = make_cells({}, how);
  ASSERT_EQ(list.cells.size(), 4u);  // x: 2, y: 2, z: 1
  EXPECT_EQ(list.cells[0].min, glm::vec3(-4, 0, 0));
  EXPECT_EQ(list.cells[0].max, glm::vec3(0, 2, 4));
  EXPECT_EQ(list.cells[3].min, glm::vec3(0, 2, 0));
  std::set<std::uint64_t> places;
  for (const view_cell& c : list.cells) places.insert(c.place);
  EXPECT_EQ(places.size(), 4u);
}

TEST(grid, neighbors_share_their_floats) {
  settings how;
  how.cell_size = 0.3f;
  how.cells_grid = {{100.0f, 0.0f, 0.0f, 103.0f, 0.1f, 0.1f}};
  const cell_list list = make_cells({}, how);
  for (std::size_t i = 1; i < list.cells.size(); ++i) EXPECT_EQ(list.cells[i - 1].max.x, list.cells[i].min.x);
}

TEST(grid, refuses_what_nobody_can_bake) {
  settings how;
  how.cells_grid = {{-1e6f, 0.0f, -1e6f, 1e6f, 2.0f, 1e6f}};
  EXPECT_THROW(make_cells({}, how), error);
  how.cells_grid = {{9e9f, 0.0f, 0.0f, 9.1e9f, 2.0f, 4.0f}};
  how.cell_size = 0.25f;
  EXPECT_THROW(make_cells({}, how), error);
}

TEST(cell_limit, spreads_over_the_list) {
  settings how;
  how.cells_grid = {{0.0f, 0.0f, 0.0f, 40.0f, 2.0f, 4.0f}};
  how.cell_limit = 2;
  const cell_list list = make_cells({}, how);
  ASSERT_EQ(list.cells.size(), 2u);
  EXPECT_EQ(list.cells[0].min.x, 8.0f);
  EXPECT_EQ(list.cells[1].min.x, 28.0f);
  EXPECT_NE(list.how.find("2 of 10 cells"), std::string::npos);
  how.cell_limit = 99;
  EXPECT_EQ(make_cells({}, how).cells.size(), 10u);
}

TEST(cell_limit, keeps_the_nearest_in_the_order_of_the_list) {
  settings how;
  how.cells_grid = {{0.0f, 0.0f, 0.0f, 40.0f, 2.0f, 4.0f}};
  how.near = {{33.0f, 1.0f, 9.0f}};
  EXPECT_EQ(make_cells({}, how).cells.size(), 10u) << "without a limit it has no effect";
  EXPECT_EQ(describe(how).find("near"), std::string::npos);
  how.cell_limit = 2;
  const cell_list list = make_cells({}, how);
  ASSERT_EQ(list.cells.size(), 2u);
  EXPECT_EQ(list.cells[0].min.x, 28.0f);
  EXPECT_EQ(list.cells[1].min.x, 32.0f);
  EXPECT_NE(list.how.find("2 nearest of 10 cells"), std::string::npos);
  EXPECT_NE(describe(how).find(R"("cell_limit":2)"), std::string::npos);
  EXPECT_NE(describe(how).find(R"("near":[33,1,9])"), std::string::npos);
}

TEST(lattice, cells_over_floors_are_wider_by_levels_and_higher_by_layers) {
  const lattice on = lattice::over_floors(4.0);
  const view_cell cell = on.cell({.z = -1, .y = -3, .x = 1, .level = 2, .layers = 5});
  EXPECT_EQ(cell.min, glm::vec3(16, -1.5f, -16));
  EXPECT_EQ(cell.max, glm::vec3(32, 1.0f, 0));
  std::set<std::uint64_t> places;
  for (const std::int32_t level : {0, 2})
    for (const std::int32_t layers : {1, 5})
      places.insert(on.cell({.z = -1, .y = -3, .x = 1, .level = level, .layers = layers}).place);
  EXPECT_EQ(places.size(), 4u) << "other random numbers";
}

}  // namespace
}  // namespace sightcell::bake
