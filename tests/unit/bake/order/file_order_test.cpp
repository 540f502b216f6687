#include "order/file_order.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sightcell/format/cell_lattice.h"

namespace sightcell::bake {
namespace {

// Cells of 4 m on a lattice, from the last one to the first, with numbers that are those of their boxes.
format::file_parts cells_from_last_to_first() {
  format::file_parts parts;
  parts.settings = R"({"cells":"grid","cell_size":4.0})";
  parts.player_radius = 0.05f;
  for (std::int32_t z = 9; z >= -9; --z)
    for (std::int32_t x = 9; x >= -9; --x) {
      const auto cell = static_cast<std::uint32_t>(parts.cells.size());
      parts.cells.push_back(format::box_of({4.0, 2.0}, format::lattice_place{x, 0, z, 0}));
      const std::uint32_t number = static_cast<std::uint32_t>(20 * (x + 10) + z + 10);
      parts.certificate.push_back({.cell = cell, .rays = number});
      parts.viewpoints.push_back({.cell = cell, .outside_share = number / 1000.0, .region = {std::byte{0x12}}});
      parts.viewpoints.back().eyes = {{static_cast<std::uint16_t>(number), 0, 0}};
    }
  return parts;
}

TEST(file_order, records_follow_their_cells) {
  format::file_parts parts = cells_from_last_to_first();
  const format::file_parts before = parts;
  const std::vector<std::uint32_t> numbers = order_cells(parts);
  ASSERT_EQ(numbers.size(), before.cells.size());
  EXPECT_FALSE(std::is_sorted(numbers.begin(), numbers.end()));
  ASSERT_EQ(parts.viewpoints.size(), numbers.size());
  for (std::uint32_t cell = 0; cell < numbers.size(); ++cell) {
    EXPECT_EQ(parts.cells[cell].min, before.cells[numbers[cell]].min);
    EXPECT_EQ(parts.certificate[cell].cell, cell);
    EXPECT_EQ(parts.certificate[cell].rays, before.certificate[numbers[cell]].rays);
    EXPECT_EQ(parts.viewpoints[cell].cell, cell);
    EXPECT_EQ(parts.viewpoints[cell].outside_share, before.viewpoints[numbers[cell]].outside_share);
    EXPECT_EQ(parts.viewpoints[cell].region, before.viewpoints[numbers[cell]].region);
    EXPECT_EQ(parts.viewpoints[cell].eyes, before.viewpoints[numbers[cell]].eyes);
  }
  parts = before;
  parts.certificate.clear();
  parts.viewpoints.clear();
  EXPECT_EQ(order_cells(parts), numbers) << "a file may have neither";
  EXPECT_TRUE(parts.viewpoints.empty());
  EXPECT_FALSE(parts.grid);
}

TEST(file_order, cells_of_several_heights_keep_their_order) {
  format::file_parts parts = cells_from_last_to_first();
  parts.cells[5].max[1] = 1.5f;
  const format::file_parts before = parts;
  EXPECT_TRUE(order_cells(parts).empty());
  EXPECT_FALSE(parts.lattice);
  ASSERT_TRUE(parts.grid);
  ASSERT_EQ(parts.grid_places.size(), before.cells.size());
  EXPECT_EQ(parts.grid_places[4].x, 5);
  EXPECT_EQ(parts.grid_places[4].steps_y, 4u);
  EXPECT_EQ(parts.grid_places[5].steps_y, 3u);
  EXPECT_EQ(parts.certificate[7].rays, before.certificate[7].rays);
  const format::file_contents contents = parts.contents({});
  EXPECT_TRUE(contents.cells.empty());
  ASSERT_TRUE(contents.grid);
  EXPECT_EQ(contents.grid->places.size(), before.cells.size());
}

}  // namespace
}  // namespace sightcell::bake
