#include "order/find_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "cells/lattice.h"
#include "sightcell/format/cell_lattice.h"
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

// Cells of several widths in layers of one height; the second time in layers of twice the height, as they are where a
// large scene made the lattice coarser.
TEST(find_lattice, finds_merged_cells) {
  for (const double coarser : {1.0, 2.0}) {
    const lattice on(1.7f * coarser);
    std::vector<format::box> boxes;
    for (std::int32_t level = 1; level <= 3; ++level)
      for (std::int64_t x = -3; x < 4; ++x) {
        const view_cell c = on.cell({.z = 4 * level - 9, .y = level - 2, .x = x, .level = level});
        boxes.push_back({{c.min.x, c.min.y, c.min.z}, {c.max.x, c.max.y, c.max.z}});
      }
    const auto found = find_lattice(boxes, settings_with("1.7"));
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->shape.layers);
    EXPECT_EQ(found->shape.width, static_cast<double>(1.7f) * coarser * 8.0);
    expect_same_boxes(boxes, *found);
    boxes.resize(7);  // all of one width
    const auto of_one_width = find_lattice(boxes, settings_with("1.7"));
    ASSERT_TRUE(of_one_width);
    EXPECT_FALSE(of_one_width->shape.layers);
    expect_same_boxes(boxes, *of_one_width);
  }
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
