// View cells: files, grids and walkable floors. Scenes are a few quads, one behavior each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include "cells/cells_file.h"
#include "cells/lattice.h"
#include "cells/view_cell.h"
#include "errors/error_id.h"
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

cell_list cells_of(const scene::world_geometry& g, const settings& how = {}) {
  return make_cells(g, how);
}

bool holds(const view_cell& cell, glm::vec3 p) {
  return p.x >= cell.min.x && p.x < cell.max.x && p.y >= cell.min.y && p.y < cell.max.y && p.z >= cell.min.z &&
         p.z < cell.max.z;
}

bool any_holds(const cell_list& list, glm::vec3 p) {
  return std::any_of(list.cells.begin(), list.cells.end(), [&](const view_cell& c) { return holds(c, p); });
}

std::string error_of(const std::string& text) {
  try {
    parse_cells(text, "cells.json");
  } catch (const error& e) {
    EXPECT_EQ(e.kind(), error_kind::bad_input);
    return e.what();
  }
  return "no error";
}

TEST(cells_file, reads_boxes_in_order) {
  const auto cells = parse_cells(
      R"({"cells":[{"name":"lane 3","min":[0,0,0],"max":[4,2,4],"more":1},{"min":[-1.5,0,0],"max":[0,1,1]}]})", "f");
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].name, "lane 3");
  EXPECT_EQ(cells[0].max, glm::vec3(4, 2, 4));
  EXPECT_EQ(cells[1].name, "");
  EXPECT_EQ(cells[1].min, glm::vec3(-1.5f, 0, 0));
  EXPECT_NE(cells[0].place, cells[1].place);
}

TEST(cells_file, place_depends_on_the_six_floats_alone) {
  const auto a = parse_cells(R"({"cells":[{"name":"a","min":[0,0,0],"max":[4,2,4]}]})", "f");
  const auto b = parse_cells(R"({"cells":[{"min":[-1,0,0],"max":[4,2,4]},{"min":[-0.0,0,0],"max":[4,2,4]}]})", "f");
  EXPECT_EQ(a[0].place, b[1].place);
  EXPECT_NE(a[0].place, b[0].place);
}

TEST(cells_file, errors_name_cell_and_cause) {
  EXPECT_NE(error_of("{").find("cells.json: not JSON: "), std::string::npos);
  EXPECT_NE(error_of("[1]").find("[cells.no-list]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":{}})").find("[cells.no-list]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[]})").find("empty"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[7]})").find("cell 0 is not an object"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0]}]})").find("cell 0 has no \"max\""), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0],"max":[1,1,1]}]})").find("[cells.bad-box]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,"a",0],"max":[1,1,1]}]})").find("holds a string"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"name":3,"min":[0,0,0],"max":[1,1,1]}]})").find("[cells.bad-name]"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"name":"x","min":[0,5,0],"max":[1,5,1]}]})")
                .find("cell 0 \"x\": min 5 is not below max 5 on y"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,1e9]}]})").find("[cells.too-far]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,1e999]}]})").find("[cells.not-json]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,NaN]}]})").find("[cells.not-json]"), std::string::npos);
  // Different in double, the same in single precision.
  EXPECT_NE(error_of(R"({"cells":[{"min":[1000000.0,0,0],"max":[1000000.0001,1,1]}]})").find("[cells.empty-box]"),
            std::string::npos);
}

TEST(cells, boxes_of_a_host_are_finite) {
  settings how;
  how.cells.push_back({"stand", {0, 0, 0}, {1, std::numeric_limits<float>::infinity(), 1}});
  EXPECT_EQ(test::error_id([&] { make_cells({}, how); }), "cells.not-finite");
  how.cells[0].max[1] = std::nanf("");
  EXPECT_EQ(test::error_id([&] { make_cells({}, how); }), "cells.not-finite");
}

TEST(cells_file, missing_file_is_named) {
  try {
    read_cells_file("no/such/cells.json");
    FAIL();
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "cells.unreadable");
    EXPECT_NE(std::string(e.what()).find("no/such/cells.json"), std::string::npos);
  }
  EXPECT_THROW(read_cells_file(std::filesystem::temp_directory_path()), error);  // a folder
}

TEST(grid, takes_every_cell_that_overlaps_the_box) {
  settings how;
  how.cells_grid = {{-1.0f, 0.0f, 0.0f, 4.0f, 2.5f, 4.0f}};
  const cell_list list = cells_of({}, how);
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
  const cell_list list = cells_of({}, how);
  for (std::size_t i = 1; i < list.cells.size(); ++i) EXPECT_EQ(list.cells[i - 1].max.x, list.cells[i].min.x);
}

TEST(grid, refuses_what_nobody_can_bake) {
  settings how;
  how.cells_grid = {{-1e6f, 0.0f, -1e6f, 1e6f, 2.0f, 1e6f}};
  EXPECT_THROW(cells_of({}, how), error);
  how.cells_grid = {{9e9f, 0.0f, 0.0f, 9.1e9f, 2.0f, 4.0f}};
  how.cell_size = 0.25f;
  EXPECT_THROW(cells_of({}, how), error);
}

TEST(cell_limit, spreads_over_the_list) {
  settings how;
  how.cells_grid = {{0.0f, 0.0f, 0.0f, 40.0f, 2.0f, 4.0f}};
  how.cell_limit = 2;
  const cell_list list = cells_of({}, how);
  ASSERT_EQ(list.cells.size(), 2u);
  EXPECT_EQ(list.cells[0].min.x, 8.0f);
  EXPECT_EQ(list.cells[1].min.x, 28.0f);
  EXPECT_NE(list.how.find("2 of 10 cells"), std::string::npos);
  how.cell_limit = 99;
  EXPECT_EQ(cells_of({}, how).cells.size(), 10u);
}

TEST(walkable, one_layer_of_cells_over_a_floor) {
  scene::world_geometry g;
  add_floor(g, 0.5f, 0.5f, 7.5f, 7.5f, 0.0f);
  const cell_list list = cells_of(g);
  ASSERT_EQ(list.cells.size(), 4u);
  for (const view_cell& c : list.cells) {
    EXPECT_EQ(c.min.y, 0.0f);
    EXPECT_EQ(c.max.y, 2.0f);
  }
  EXPECT_TRUE(list.warnings.empty());
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
  settings how;
  how.all_double_sided = true;
  EXPECT_NE(cells_of(g, how).how.find("walkable"), std::string::npos);
  for (scene::polygon_kind& kind : g.kinds) kind.double_sided = true;
  EXPECT_NE(cells_of(g).how.find("walkable"), std::string::npos);
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
  EXPECT_FALSE(list.warnings.empty());
}

TEST(walkable, huge_terrain_gets_larger_cells_and_a_warning) {
  scene::world_geometry g;
  add_floor(g, -2000.0f, -2000.0f, 2000.0f, 2000.0f, 0.0f);
  const cell_list list = cells_of(g);
  EXPECT_LE(list.cells.size(), 200'000u);
  EXPECT_GT(list.cells.size(), 40'000u);
  EXPECT_EQ(list.cells[0].max.x - list.cells[0].min.x, 16.0f);
  EXPECT_FALSE(list.warnings.empty());
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

TEST(lattice, coarser_places_round_down) {
  EXPECT_EQ(lattice::coarser({.z = -1, .y = -2, .x = 3}), (lattice_position{.z = -1, .y = -1, .x = 1}));
  std::vector<lattice_position> p = {{0, 0, -2}, {0, 0, -1}, {0, 0, 0}, {0, 0, 1}};
  const lattice on = coarsen_until(p, lattice(4.0), 2);
  EXPECT_EQ(on.width(), 8.0);
  ASSERT_EQ(p.size(), 2u);
  EXPECT_EQ(on.cell(p[0]).min.x, -8.0f);
}

}  // namespace
}  // namespace sightcell::bake
