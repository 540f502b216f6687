#include "job/merge_cells.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "cells/lattice.h"
#include "hemicube/choice/choose_source.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

// A field of 64 x 64 m, two blocks wide, with a ring of posts around it.
tiny_scene field() {
  tiny_scene tiny;
  tiny.quad({-40, 0, -40}, {-40, 0, 40}, {40, 0, 40}, {40, 0, -40});
  for (int i = 0; i < 40; ++i) {
    const float at = -40.0f + 2.0f * static_cast<float>(i);
    tiny.closed_box({at, 0, -41}, {at + 1, 30, -40});
    tiny.closed_box({at, 0, 40}, {at + 1, 30, 41});
  }
  return tiny;
}

// Cells of 4 m over part of it, 16 m2 of floor each, that begin `rise` layers higher from column to column along x.
cell_list cells_over(std::int64_t from, std::int64_t to, std::int64_t rise = 0) {
  const lattice on = lattice::over_floors(4.0);
  cell_list list;
  for (std::int64_t z = from; z < to; ++z)
    for (std::int64_t x = from; x < to; ++x) {
      list.cells.push_back(on.cell({.z = z, .y = 1 + rise * x, .x = x, .layers = 4}));
      list.cells.back().floor_area = 16.0;
    }
  list.can_merge = true;
  list.cell_width = 4.0;
  list.where = "over grass";
  return list;
}

settings small_cubes(double growth) {
  settings how;
  how.merge_cells = growth;
  how.resolution = 128;
  how.source = "cpu";
  return how;
}

cell_list merge_of(tiny_scene tiny, cell_list list, const settings& how) {
  const test::scene_with_rays w(tiny);
  const chosen_source chosen = choose_source(how, w.geometry, w.rays);
  double last = 0.0;
  merge_cells(list, how, {w.rays, *chosen.source, w.s.polygon_count}, [&](double share) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1.0);
    last = share;
  });
  EXPECT_EQ(last, 1.0);
  return list;
}

double area_of(const cell_list& list) {
  double area = 0.0;
  for (const view_cell& c : list.cells)
    area += static_cast<double>(c.max.x - c.min.x) * static_cast<double>(c.max.z - c.min.z);
  return area;
}

TEST(merge_cells, an_open_field_has_wide_cells) {
  const cell_list list = merge_of(field(), cells_over(-8, 8), small_cubes(0.3));
  EXPECT_EQ(list.cells.size(), 4u);
  for (const view_cell& c : list.cells) {
    EXPECT_EQ(c.max.x - c.min.x, 32.0f);
    EXPECT_EQ(c.max.y - c.min.y, 2.0f);
  }
  EXPECT_EQ(list.how, "4 cells of 4 to 32 m, merged from 256 of 4 m, over grass");
}

// One layer of 0.5 m higher per 4 m: a block of eight columns is a cell that contains all of theirs.
TEST(merge_cells, cells_up_a_slope_become_one_that_is_higher) {
  const cell_list list = merge_of(field(), cells_over(0, 8, 1), small_cubes(0.3));
  ASSERT_EQ(list.cells.size(), 1u);
  EXPECT_EQ(list.cells[0].min, glm::vec3(0, 0.5f, 0));
  EXPECT_EQ(list.cells[0].max, glm::vec3(32, 6, 32));
}

// Columns of 0.5 to 2.5 m in a room, and columns of 2 to 4 m behind a wall. Posts are visible only from the roof of the
// room, which is in the cell around all of them and in none of the columns.
TEST(merge_cells, what_is_visible_from_between_the_cells_counts) {
  tiny_scene tiny = field();
  tiny.closed_box({4, 0, -40}, {4.1f, 40, 40});
  tiny.closed_box({-1.1f, 0, -1}, {-1, 2.6f, 9});
  tiny.closed_box({-1, 0, -1.1f}, {4, 2.6f, -1});
  tiny.closed_box({-1, 0, 9}, {4, 2.6f, 9.1f});
  tiny.closed_box({-1, 2.6f, -1}, {4, 2.65f, 9});
  EXPECT_EQ(merge_of(tiny, cells_over(0, 2, 3), small_cubes(1.3)).cells.size(), 1u);
  for (int i = 0; i < 200; ++i) {
    const float x = -5.0f - static_cast<float>(i % 14), z = -5.0f + static_cast<float>(i / 14);
    tiny.closed_box({x, 3, z}, {x + 0.2f, 8, z + 0.2f});
  }
  EXPECT_EQ(merge_of(tiny, cells_over(0, 2, 3), small_cubes(1.3)).cells.size(), 4u);
}

// Two walls that cross at (16, 16), so in the middle of a block, and 200 posts in one of the quarters.
tiny_scene quarters() {
  tiny_scene tiny = field();
  tiny.closed_box({15.9f, -1, -40}, {16.1f, 40, 40});
  tiny.closed_box({-40, -1, 15.9f}, {40, 40, 16.1f});
  for (int i = 0; i < 200; ++i) {
    const float x = 17.0f + static_cast<float>(i % 14), z = 17.0f + static_cast<float>(i / 14);
    tiny.closed_box({x, 0, z}, {x + 0.02f, 3, z + 0.02f});
  }
  return tiny;
}

TEST(merge_cells, no_cell_reaches_through_a_wall) {
  const cell_list list = merge_of(quarters(), cells_over(0, 8), small_cubes(0.1));
  EXPECT_LT(list.cells.size(), 40u);
  EXPECT_EQ(area_of(list), 32.0 * 32.0) << "each place is in one cell";
  for (const view_cell& c : list.cells) {
    if (c.max.x <= 16.0f || c.max.z <= 16.0f) continue;
    EXPECT_TRUE(c.min.x >= 16.0f && c.min.z >= 16.0f);
  }
}

// Five of 16 places have floor: the square around them is mostly not to be looked from.
TEST(merge_cells, a_square_with_little_floor_stays_in_parts) {
  cell_list list = cells_over(0, 4);
  list.cells.resize(5);
  const cell_list merged_list = merge_of(field(), list, small_cubes(5.0));
  for (const view_cell& c : merged_list.cells) EXPECT_LE(c.max.x - c.min.x, 8.0f);
}

TEST(merge_cells, threads_and_the_order_of_cells_do_not_matter) {
  const cell_list first = merge_of(quarters(), cells_over(-8, 8), small_cubes(0.02));
  cell_list reversed = cells_over(-8, 8);
  std::reverse(reversed.cells.begin(), reversed.cells.end());
  cell_list again;
  tbb::task_arena alone(1);
  alone.execute([&] { again = merge_of(quarters(), reversed, small_cubes(0.02)); });
  ASSERT_EQ(again.cells.size(), first.cells.size());
  for (std::size_t i = 0; i < first.cells.size(); ++i) EXPECT_EQ(again.cells[i].position, first.cells[i].position);
}

TEST(merge_cells, a_limit_considers_some_blocks) {
  settings how = small_cubes(0.0001);
  how.cell_limit = 8;
  const cell_list list = merge_of(quarters(), cells_over(-16, 16), how);
  EXPECT_NE(list.how.find("in 1 of 16 blocks"), std::string::npos) << list.how;
  EXPECT_LE(list.cells.size(), 64u);
}

TEST(merge_cells, reports_the_parts_of_a_block) {
  const test::scene_with_rays w(quarters());
  settings how = small_cubes(0.1);
  how.cell_limit = 1;  // one block
  const chosen_source chosen = choose_source(how, w.geometry, w.rays);
  cell_list list = cells_over(-16, 16);
  std::vector<double> shares;
  merge_cells(list, how, {w.rays, *chosen.source, w.s.polygon_count}, [&](double share) { shares.push_back(share); });
  ASSERT_GE(shares.size(), 3u);
  EXPECT_GT(shares.front(), 0.0);
  EXPECT_LT(shares.front(), 0.9);
}

TEST(merge_cells, a_report_can_end_the_work) {
  const test::scene_with_rays w(field());
  const settings how = small_cubes(0.1);
  const chosen_source chosen = choose_source(how, w.geometry, w.rays);
  cell_list list = cells_over(-8, 8);
  struct enough {};
  EXPECT_THROW(merge_cells(list, how, {w.rays, *chosen.source, w.s.polygon_count}, [](double) { throw enough(); }),
               enough);
}

}  // namespace
}  // namespace sightcell::bake
