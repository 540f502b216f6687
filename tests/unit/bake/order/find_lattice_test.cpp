#include "order/find_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cells/lattice.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/grid_boxes.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
namespace {

// The boxes of a bake on such a lattice, row by row as they are made.
std::vector<format::box> boxes_of(double cell_size) {
  const lattice on(cell_size);
  std::vector<format::box> boxes;
  for (int z = -9; z < 12; ++z)
    for (int y = -1; y < 2; ++y)
      for (int x = -20; x < 5; ++x) {
        if ((x * 7 + y * 5 + z * 3) % 4 == 0) continue;
        const view_cell c = on.cell({.z = z, .y = y, .x = x});
        boxes.push_back({{c.min.x, c.min.y, c.min.z}, {c.max.x, c.max.y, c.max.z}});
      }
  return boxes;
}

std::string settings_with(const std::string& cell_size, const std::string& kind = "automatic") {
  return R"({"cells":")" + kind + R"(","cell_size":)" + cell_size + "}";
}

void expect_same_boxes(const std::vector<format::box>& boxes, const cells_on_lattice& found) {
  ASSERT_EQ(found.cells.size(), boxes.size());
  ASSERT_EQ(found.places.size(), boxes.size());
  std::vector<bool> seen(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const format::box b = format::box_of(found.shape, found.places[i]);
    EXPECT_EQ(b.min, boxes[found.cells[i]].min);
    EXPECT_EQ(b.max, boxes[found.cells[i]].max);
    EXPECT_FALSE(seen[found.cells[i]]);
    seen[found.cells[i]] = true;
    EXPECT_TRUE(i == 0 || format::lattice_comes_before(found.places[i - 1], found.places[i]));
  }
}

// Also sizes that no float and no double has exactly, and cells that were made twice or four times as large.
TEST(find_lattice, finds_the_lattice_of_a_bake) {
  for (const auto& [size, text] : {std::pair(4.0f, "4.0"), std::pair(0.3f, "0.3"), std::pair(1.7f, "1.7")})
    for (const double coarser : {1.0, 2.0, 4.0}) {
      const auto boxes = boxes_of(static_cast<double>(size) * coarser);
      const auto found = find_lattice(boxes, settings_with(text));
      ASSERT_TRUE(found) << text << " " << coarser;
      EXPECT_EQ(found->shape.width, static_cast<double>(size) * coarser);
      expect_same_boxes(boxes, *found);
    }
  EXPECT_TRUE(find_lattice(boxes_of(4.0), settings_with("4", "grid")));
}

void expect_same_boxes(const std::vector<format::box>& boxes, const cells_on_grid& found) {
  ASSERT_EQ(found.places.size(), boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const format::box b = format::box_of(found.step, found.places[i]);
    EXPECT_EQ(b.min, boxes[i].min);
    EXPECT_EQ(b.max, boxes[i].max);
  }
}

// The boxes of cells over floors, of these levels, with heights of one to seven layers.
std::vector<format::box> boxes_over_floors(double cell_size, std::int32_t first_level, std::int32_t last_level) {
  const lattice on = lattice::over_floors(cell_size);
  std::vector<format::box> boxes;
  for (std::int32_t level = first_level; level <= last_level; ++level)
    for (std::int32_t x = -3; x < 4; ++x) {
      const view_cell c = on.cell({.z = 4 * level - 9, .y = 3 * x - level, .x = x, .level = level, .layers = 4 + x});
      boxes.push_back({{c.min.x, c.min.y, c.min.z}, {c.max.x, c.max.y, c.max.z}});
    }
  return boxes;
}

// Also cells that were all merged, and cells that were made twice as large for a large scene.
TEST(find_lattice, finds_the_grid_of_a_bake) {
  for (const double coarser : {1.0, 2.0})
    for (const std::int32_t level : {0, 1, 3}) {
      const double size = static_cast<double>(1.7f) * coarser;
      const auto boxes = boxes_over_floors(size, level, level + 2);
      EXPECT_FALSE(find_lattice(boxes, settings_with("1.7")));
      const auto found = find_grid(boxes, settings_with("1.7"));
      ASSERT_TRUE(found) << coarser << " " << level;
      EXPECT_EQ(found->step.width, size * (1 << level));
      if (level == 0) {
        EXPECT_EQ(found->step.height, size / 8.0);
      }
      expect_same_boxes(boxes, *found);
    }
  const auto boxes = boxes_over_floors(4.0, 0, 2);
  const auto found = find_grid(boxes, settings_with("4", "grid"));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->places[1].x, -2);
  EXPECT_EQ(found->places[1].steps_y, 2u);
  EXPECT_EQ(found->places[20].steps_x, 4u);
}

TEST(find_lattice, boxes_beside_the_grid_are_boxes) {
  auto boxes = boxes_over_floors(4.0, 0, 2);
  EXPECT_FALSE(find_grid(boxes, settings_with("4", "file")));
  EXPECT_FALSE(find_grid(boxes, settings_with("4", "given")));
  EXPECT_FALSE(find_grid(boxes, settings_with("3")));
  EXPECT_FALSE(find_grid(boxes, settings_with("-4")));
  EXPECT_FALSE(find_grid(boxes, settings_with("1e-30"))) << "steps without number";
  EXPECT_FALSE(find_grid(boxes, ""));
  EXPECT_FALSE(find_grid({}, settings_with("4")));
  EXPECT_TRUE(find_grid(boxes, settings_with("4")));
  boxes.push_back(boxes.front());
  EXPECT_TRUE(find_grid(boxes, settings_with("4"))) << "the same box twice";
  boxes[7].max[1] = std::nextafter(boxes[7].max[1], 1000.0f);
  EXPECT_FALSE(find_grid(boxes, settings_with("4")));
  boxes[7] = {{0, 0, 0}, {1e30f, 4, 4}};
  EXPECT_FALSE(find_grid(boxes, settings_with("4")));
}

TEST(find_lattice, cells_by_hand_keep_their_numbers) {
  EXPECT_FALSE(find_lattice(boxes_of(4.0), settings_with("4", "file")));
  EXPECT_FALSE(find_lattice(boxes_of(4.0), settings_with("4", "given")));
}

TEST(find_lattice, boxes_beside_the_lattice_are_boxes) {
  auto boxes = boxes_of(4.0);
  boxes[7].max[1] = std::nextafter(boxes[7].max[1], 1000.0f);
  EXPECT_FALSE(find_lattice(boxes, settings_with("4.0")));
  EXPECT_FALSE(find_lattice(boxes_of(4.0), settings_with("3.0")));
  EXPECT_FALSE(find_lattice(boxes_of(4.0), settings_with("\"4\"")));
  EXPECT_FALSE(find_lattice(boxes_of(4.0), settings_with("-4")));
  EXPECT_FALSE(find_lattice(boxes_of(4.0), ""));
  EXPECT_FALSE(find_lattice(boxes_of(4.0), "[1]"));
  EXPECT_FALSE(find_lattice({}, settings_with("4")));
  boxes = boxes_of(4.0);
  boxes.push_back(boxes.front());
  EXPECT_FALSE(find_lattice(boxes, settings_with("4"))) << "the same cell twice";
}

}  // namespace
}  // namespace sightcell::bake
