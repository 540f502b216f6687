#include "sightcell/format/grid_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "byte_sink.h"
#include "grid_boxes_writer.h"
#include "random_source.h"
#include "sightcell/format/cell_lattice.h"

namespace {

using namespace sightcell::format;
using sightcell::test::random_source;

constexpr std::size_t head = 16 + 6 * packed_columns::descriptor_size;

bool same(const box& a, const box& b) {
  return a.min == b.min && a.max == b.max;
}

bool same(const grid_box& a, const grid_box& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.steps_x == b.steps_x && a.steps_y == b.steps_y &&
         a.steps_z == b.steps_z;
}

// In memory of exactly this size, so that the sanitizer detects a load after its end.
std::vector<std::byte> written(const lattice_shape& step, const std::vector<grid_box>& places) {
  std::vector<std::byte> bytes;
  EXPECT_TRUE(put_grid(step, places, bytes));
  bytes.shrink_to_fit();
  return bytes;
}

std::vector<grid_box> random_places(std::uint32_t seed, int count) {
  random_source random(seed);
  std::vector<grid_box> places;
  for (int i = 0; i < count; ++i) {
    const auto any = [&] { return static_cast<std::int32_t>(random() % 200) - 100; };
    const auto steps = [&] { return 1 + random() % 9; };
    places.push_back({any(), any(), any(), steps(), steps(), steps()});
  }
  return places;
}

TEST(grid_boxes, boxes_of_places) {
  EXPECT_TRUE(same(box_of(lattice_shape{4.0, 0.5}, grid_box{-1, 3, 2, 2, 5, 1}), {{-4, 1.5, 8}, {4, 4, 12}}));
  EXPECT_TRUE(same(box_of(lattice_shape{1.0, 1.0}, grid_box{-2147483647 - 1, 0, 2147483647, 4294967295, 1, 1u << 31}),
                   {{-2147483648.0f, 0, 2147483648.0f}, {2147483648.0f, 1, 4294967296.0f}}));
  // Boxes that meet share exact floats, for any sizes: each border is rounded once.
  const lattice_shape odd{0.7, 0.31};
  for (std::int32_t at = -1000; at < 1000; ++at) {
    const box all = box_of(odd, grid_box{at - 7, at - 7, at - 7, 7, 7, 7});
    const box next = box_of(odd, grid_box{at, at, at});
    ASSERT_EQ(all.max, next.min);
    ASSERT_EQ(next.min[0], static_cast<float>(at * 0.7));
    ASSERT_EQ(next.min[1], static_cast<float>(at * 0.31));
    ASSERT_EQ(next.min[2], static_cast<float>(at * 0.7));
  }
}

TEST(grid_boxes, every_cell_has_its_place) {
  for (const int count : {1, 5, 64, 3000}) {
    const auto places = random_places(static_cast<std::uint32_t>(count), count);
    const auto bytes = written({0.7, 0.31}, places);
    grid_boxes grid;
    ASSERT_TRUE(grid.open(bytes, static_cast<std::uint32_t>(count)));
    EXPECT_EQ(grid.step().width, 0.7);
    EXPECT_EQ(grid.step().height, 0.31);
    for (std::uint32_t cell = 0; cell < places.size(); ++cell) ASSERT_TRUE(same(grid.place(cell), places[cell]));
    static_cast<void>(grid.place(static_cast<std::uint32_t>(count)));
    static_cast<void>(grid.place(0xFFFFFFFF));
  }
}

TEST(grid_boxes, small_numbers_take_few_bits) {
  std::vector<grid_box> places;
  for (std::int32_t i = 0; i < 64; ++i)
    places.push_back({1000 + i % 16, -5, i / 16, 1, 1u + static_cast<std::uint32_t>(i % 2), 1});
  EXPECT_EQ(written({1.0, 1.0}, places).size(), head + (4 + 2 + 1) * 8);
}

TEST(grid_boxes, boxes_may_be_equal) {
  const grid_box one{3, 4, 5, 2, 2, 2};
  const auto bytes = written({1.0, 1.0}, {one, one, one});
  EXPECT_EQ(bytes.size(), head);
  grid_boxes grid;
  ASSERT_TRUE(grid.open(bytes, 3));
  EXPECT_TRUE(same(grid.place(2), one));
}

TEST(grid_boxes, places_without_a_box_are_not_written) {
  std::vector<std::byte> bytes;
  const auto puts = [&](const lattice_shape& step, const grid_box& place) {
    return put_grid(step, std::vector{place}, bytes);
  };
  EXPECT_FALSE(puts({1.0, 1.0}, {0, 0, 0, 0, 1, 1}));
  EXPECT_FALSE(puts({1.0, 1.0}, {0, 0, 0, 1, 0, 1}));
  EXPECT_FALSE(puts({1.0, 1.0}, {0, 0, 0, 1, 1, 0}));
  EXPECT_FALSE(puts({1e38, 1.0}, {0, 0, 0, 5, 1, 1}));       // infinite
  EXPECT_FALSE(puts({1.0, 1.0}, {1 << 28, 0, 0, 1, 1, 1}));  // min is max in floats
  EXPECT_FALSE(put_grid({0.0, 1.0}, std::vector<grid_box>{}, bytes));
  EXPECT_FALSE(put_grid({1.0, static_cast<double>(INFINITY)}, std::vector<grid_box>{}, bytes));
  EXPECT_TRUE(bytes.empty());
  EXPECT_TRUE(puts({1.0, 1.0}, {1 << 28, 0, 0, 64, 1, 1}));
}

TEST(grid_boxes, other_shapes_and_counts_are_refused) {
  const auto bytes = written({1.0, 1.0}, random_places(3, 100));
  grid_boxes grid;
  EXPECT_FALSE(grid.open(bytes, 99));
  EXPECT_FALSE(grid.open(bytes, 101));
  for (const std::size_t at : {std::size_t{0}, std::size_t{8}}) {
    for (const double bad : {0.0, -4.0, std::nan(""), static_cast<double>(INFINITY)}) {
      auto changed = bytes;
      std::vector<std::byte> number;
      byte_sink(number).put_f64(bad);
      std::copy(number.begin(), number.end(), changed.begin() + static_cast<std::ptrdiff_t>(at));
      EXPECT_FALSE(grid.open(changed, 100)) << at << " " << bad;
    }
  }
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(grid.open(cut, 100)) << size;
  }
  EXPECT_TRUE(grid.open(bytes, 100));
}

}  // namespace
