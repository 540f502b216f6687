#include "cells/decided_cells.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "cells/cell_blocks.h"
#include "cells/lattice.h"

namespace sightcell::bake {
namespace {

view_cell cell_at(const lattice_position& position, double area, double floor) {
  view_cell cell = lattice::over_floors(4.0).cell(position);
  cell.floor_area = area, cell.floor = floor;
  return cell;
}

decided_cells three_cells() {
  decided_cells cells{.inputs = "scene 1\nand settings", .device = "cpu of a test", .list = {}, .boxes = {}};
  cells.list.how = "3 cells of 4 to 32 m";
  cells.list.warnings = {"no floor below a start", ""};
  cells.list.can_merge = true;
  cells.list.cell_width = 4.0;
  cells.list.cells = {cell_at({.z = -3, .y = 7, .x = 5, .layers = 4}, 16.0, 3.25),
                      cell_at({.z = 0, .y = -9, .x = -1, .level = 3, .layers = 12}, 800.5, -4.0),
                      cell_at({.z = 0, .y = -9, .x = 0, .level = 1}, 0.0, -4.5)};
  cells.boxes = {cell_at({.z = 2, .y = 1, .x = 8}, 4.0, 0.5)};
  return cells;
}

void expect_equal(const std::vector<view_cell>& a, const std::vector<view_cell>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].min, b[i].min);
    EXPECT_EQ(a[i].max, b[i].max);
    EXPECT_EQ(a[i].place, b[i].place);
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_TRUE(a[i].on_lattice);
    EXPECT_EQ(a[i].floor_area, b[i].floor_area);
    EXPECT_EQ(a[i].floor, b[i].floor);
  }
}

TEST(decided_cells, are_those_that_were_encoded) {
  const decided_cells before = three_cells();
  const auto after = decode_cells(encode(before));
  ASSERT_TRUE(after.has_value());
  EXPECT_EQ(after->inputs, before.inputs);
  EXPECT_EQ(after->device, before.device);
  EXPECT_EQ(after->list.how, before.list.how);
  EXPECT_EQ(after->list.warnings, before.list.warnings);
  EXPECT_TRUE(after->list.can_merge);
  EXPECT_EQ(after->list.cell_width, before.list.cell_width);
  expect_equal(after->list.cells, before.list.cells);
  expect_equal(after->boxes, before.boxes);
}

TEST(decided_cells, cut_short_or_made_longer_are_none) {
  const std::string bytes = encode(three_cells());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_cells(std::string_view(bytes).substr(0, size))) << size;
  EXPECT_FALSE(decode_cells(bytes + '\0'));
  std::string of_next_version = bytes;
  ++of_next_version[0];
  EXPECT_FALSE(decode_cells(of_next_version));
}

// Any change of a byte gives no cells, or cells that a bake can work with.
TEST(decided_cells, with_any_byte_changed_are_none_or_sound) {
  const std::string bytes = encode(three_cells());
  std::size_t none = 0, sound = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (const int flip : {0x01, 0x80, 0xFF, 0x40}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ flip);
      const auto cells = decode_cells(changed);
      if (!cells) {
        ++none;
        continue;
      }
      ++sound;
      EXPECT_EQ(encode(*cells), changed);
      for (const view_cell& cell : cells->list.cells) {
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_TRUE(std::isfinite(cell.min[axis]) && std::isfinite(cell.max[axis]));
          EXPECT_LT(cell.min[axis], cell.max[axis]);
        }
        EXPECT_TRUE(std::isfinite(cell.floor) && std::isfinite(cell.floor_area));
      }
      EXPECT_EQ(cell_blocks(cells->list.cells, 0.25f).cell_count(), cells->list.cells.size());
    }
  EXPECT_GT(none, 0u);
  EXPECT_GT(sound, 0u);
}

TEST(decided_cells, with_absurd_numbers_are_none) {
  const auto refused = [](const std::function<void(decided_cells&)>& change) {
    decided_cells cells = three_cells();
    change(cells);
    return !decode_cells(encode(cells));
  };
  constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
  constexpr double endless = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(refused([](decided_cells&) {}));
  for (const double value : {no_number, endless, -endless, 0.0, -4.0, 1e300, 1e-300})
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.cell_width = value; })) << value;
  EXPECT_TRUE(refused([](decided_cells& c) {  // a box from 0 to infinity
    c.list.cells = {cell_at({}, 1.0, 0.0)}, c.boxes.clear();
    c.list.cell_width = 1e300;
  }));
  for (const double value : {no_number, endless, -endless}) {
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.cells[1].floor = value; })) << value;
    EXPECT_TRUE(refused([&](decided_cells& c) { c.boxes[0].floor_area = value; })) << value;
  }
  EXPECT_TRUE(refused([](decided_cells& c) { c.list.cells[1].floor_area = -1.0; }));
  for (const std::int32_t level : {-1, 4, 255})
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.cells[2].position.level = level; })) << level;
  for (const std::int32_t layers : {0, -1, std::numeric_limits<std::int32_t>::max()})
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.cells[2].position.layers = layers; })) << layers;
  for (const std::int64_t index : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(),
                                   std::int64_t{1} << 33})  // the last: a box without volume in single precision
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.cells[0].position.x = index; })) << index;
  EXPECT_TRUE(refused([](decided_cells& c) { c.list.cells.push_back(c.list.cells.front()); })) << "the same twice";
  EXPECT_TRUE(refused([](decided_cells& c) { c.list.cells.clear(); }));
  for (const char* text : {"two\nlines", "\x1b[2J", "\x7f"}) {
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.how = text; }));
    EXPECT_TRUE(refused([&](decided_cells& c) { c.list.warnings[1] = text; }));
  }
}

// Numbers of items are checked against the bytes that are left before memory is taken for them.
TEST(decided_cells, counts_beyond_the_bytes_are_none) {
  const decided_cells cells = three_cells();
  const std::string bytes = encode(cells);
  const std::size_t of_cells = bytes.size() - 2 * 8 - 4 * 45;
  for (const std::uint64_t count : {std::uint64_t{5}, std::uint64_t{1} << 32, ~std::uint64_t{0}}) {
    std::string changed = bytes;
    for (std::size_t i = 0; i < 8; ++i) changed[of_cells + i] = static_cast<char>(count >> (8 * i));
    EXPECT_FALSE(decode_cells(changed)) << count;
    changed = bytes;
    for (std::size_t i = 0; i < 8; ++i) changed[1 + i] = static_cast<char>(count >> (8 * i));
    EXPECT_FALSE(decode_cells(changed)) << count;
  }
}

}  // namespace
}  // namespace sightcell::bake
