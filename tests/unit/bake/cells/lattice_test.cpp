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

TEST(lattice, coarser_places_round_down) {
  EXPECT_EQ(lattice::coarser({.z = -1, .y = -2, .x = 3}), (lattice_position{.z = -1, .y = -1, .x = 1}));
  std::vector<floor_cell> p = {{{0, 0, -2}, 1.0}, {{0, 0, -1}, 2.0}, {{0, 0, 0}, 4.0}, {{0, 0, 1}, 8.0}};
  const lattice on = coarsen_until(p, lattice(4.0), 2);
  EXPECT_EQ(on.width(), 8.0);
  ASSERT_EQ(p.size(), 2u);
  EXPECT_EQ(on.cell(p[0].position).min.x, -8.0f);
  EXPECT_EQ(p[0].area, 3.0);
  EXPECT_EQ(p[1].area, 12.0);
}

TEST(lattice, wider_cells_have_the_height_of_all) {
  const lattice on(4.0);
  const lattice_position at = lattice::wider(lattice::wider({.z = -1, .y = -3, .x = 5}));
  EXPECT_EQ(at, (lattice_position{.z = -1, .y = -3, .x = 1, .level = 2}));
  const view_cell cell = on.cell(at);
  EXPECT_EQ(cell.min, glm::vec3(16, -6, -16));
  EXPECT_EQ(cell.max, glm::vec3(32, -4, 0));
  EXPECT_NE(cell.place, on.cell({.z = -1, .y = -3, .x = 1}).place) << "other random numbers";
}

}  // namespace
}  // namespace sightcell::bake
