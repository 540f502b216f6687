#include "sightcell/format/cell_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "cell_lattice_writer.h"
#include "packed_columns_writer.h"
#include "random_source.h"
#include "sightcell/format/packed_columns.h"

namespace {

using namespace sightcell::format;
using sightcell::test::random_source;

constexpr lattice_shape shape{4.0, 2.0};

bool same(const box& a, const box& b) {
  return a.min == b.min && a.max == b.max;
}

// A town of cells around the origin, some of them split.
std::vector<lattice_place> random_places(std::uint32_t seed, std::size_t count) {
  random_source random(seed);
  std::vector<lattice_place> places;
  for (std::size_t i = 0; i < count; ++i) {
    const auto any = [&](std::uint32_t most) {
      return static_cast<std::int32_t>(random() % (2 * most)) - static_cast<std::int32_t>(most);
    };
    places.push_back({any(30), any(3), any(30), random() % 10 == 0 ? 1u : 0u});
  }
  std::sort(places.begin(), places.end(), lattice_comes_before);
  const auto equal = [](const lattice_place& a, const lattice_place& b) {
    return !lattice_comes_before(a, b) && !lattice_comes_before(b, a);
  };
  places.erase(std::unique(places.begin(), places.end(), equal), places.end());
  return places;
}

// In memory of exactly this size, so that the sanitizer detects a load after its end.
std::vector<std::byte> written(const std::vector<lattice_place>& places) {
  std::vector<std::byte> bytes;
  EXPECT_TRUE(put_lattice(shape, places, bytes));
  bytes.shrink_to_fit();
  return bytes;
}

std::vector<std::byte> with_number(std::vector<std::byte> bytes, std::size_t at, double value) {
  for (unsigned i = 0; i < 8; ++i) {
    bytes[at + i] = static_cast<std::byte>(std::bit_cast<std::uint64_t>(value) >> (8 * i) & 0xFF);
  }
  return bytes;
}

TEST(cell_lattice, boxes_of_places) {
  const box b = box_of(shape, {-1, 3, 2, 0});
  EXPECT_TRUE(same(b, {{-4, 6, 8}, {0, 8, 12}}));
  EXPECT_TRUE(same(box_of(shape, {-1, 3, 2, 2}), {{-1, 1.5, 2}, {0, 2, 3}}));
  // Adjacent cells share exact floats, for any width.
  const lattice_shape odd{0.7, 0.31};
  for (std::int32_t x = -1000; x < 1000; ++x) {
    ASSERT_EQ(box_of(odd, {x, 0, 0, 0}).max[0], box_of(odd, {x + 1, 0, 0, 0}).min[0]);
  }
}

TEST(cell_lattice, every_cell_has_its_box) {
  for (const std::size_t count : {1u, 5u, 64u, 3000u}) {
    const auto places = random_places(static_cast<std::uint32_t>(count), count);
    const auto bytes = written(places);
    cell_lattice lattice;
    ASSERT_TRUE(lattice.open(bytes, static_cast<std::uint32_t>(places.size())));
    box b;
    for (std::uint32_t cell = 0; cell < places.size(); ++cell) {
      ASSERT_TRUE(lattice.cell_box(cell, b));
      ASSERT_TRUE(same(b, box_of(shape, places[cell])));
    }
    EXPECT_FALSE(lattice.cell_box(static_cast<std::uint32_t>(places.size()), b));
    EXPECT_FALSE(lattice.cell_box(0xFFFFFFFF, b));
  }
}

TEST(cell_lattice, chunks_are_eight_by_eight) {
  std::vector<lattice_place> places;
  for (std::int32_t z = -8; z < 8; ++z)
    for (std::int32_t x = -8; x < 8; ++x) places.push_back({x, 0, z, 0});
  std::sort(places.begin(), places.end(), lattice_comes_before);
  const auto bytes = written(places);
  EXPECT_LT(bytes.size(), 20u + 7 * packed_columns::descriptor_size + 8);  // four full chunks: almost no bytes
  cell_lattice lattice;
  ASSERT_TRUE(lattice.open(bytes, 256));
  ASSERT_EQ(lattice.chunk_count(), 4u);
  const lattice_chunk second = lattice.chunk(1);
  EXPECT_EQ(second.x, 0);
  EXPECT_EQ(second.z, -1);
  EXPECT_EQ(second.first_cell, 64u);
  EXPECT_EQ(second.mask, ~std::uint64_t{0});
}

TEST(cell_lattice, no_cells_at_all) {
  const auto bytes = written({});
  cell_lattice lattice;
  EXPECT_TRUE(lattice.open(bytes, 0));
  EXPECT_FALSE(lattice.open(bytes, 1));
  box b;
  EXPECT_FALSE(lattice.cell_box(0, b));
  EXPECT_FALSE(lattice.open(with_number(bytes, 8, static_cast<double>(INFINITY)), 0));
}

TEST(cell_lattice, chunks_without_cells_are_refused) {
  const auto bytes_of = [](std::uint32_t mask) {
    std::vector<std::byte> bytes = written({});
    bytes.resize(20);
    bytes[16] = std::byte{2};  // chunks
    const auto zero = from_signed(0), one = from_signed(1);
    put_columns(
        std::vector<std::vector<std::uint32_t>>{
            {zero, one}, {zero, zero}, {zero, zero}, {0, 0}, {0, mask == 0 ? 0u : 1u}, {mask, 3}, {0, 0}},
        bytes);
    return bytes;
  };
  cell_lattice lattice;
  EXPECT_TRUE(lattice.open(bytes_of(1), 3));
  EXPECT_FALSE(lattice.open(bytes_of(0), 2));
}

TEST(cell_lattice, places_that_are_none_are_not_written) {
  std::vector<std::byte> bytes;
  const lattice_place a{0, 0, 0, 0}, b{1, 0, 0, 0};
  EXPECT_FALSE(put_lattice(shape, std::vector{b, a}, bytes));
  EXPECT_FALSE(put_lattice(shape, std::vector{a, a}, bytes));
  EXPECT_FALSE(put_lattice({1e38, 1.0}, std::vector<lattice_place>{{5, 0, 0, 0}}, bytes));       // infinite
  EXPECT_FALSE(put_lattice({1.0, 1.0}, std::vector<lattice_place>{{1 << 28, 0, 0, 0}}, bytes));  // min is max in floats
  EXPECT_FALSE(put_lattice({0.0, 1.0}, std::vector<lattice_place>{}, bytes));
  EXPECT_FALSE(put_lattice({1e10, 1e10}, std::vector<lattice_place>{{0, 0, 0, max_lattice_level + 1}}, bytes));
  EXPECT_TRUE(bytes.empty());
  EXPECT_TRUE(put_lattice({1e10, 1e10}, std::vector<lattice_place>{{0, 0, 0, max_lattice_level}}, bytes));
}

TEST(cell_lattice, other_shapes_and_counts_are_refused) {
  const auto places = random_places(3, 100);
  const auto bytes = written(places);
  const auto count = static_cast<std::uint32_t>(places.size());
  cell_lattice lattice;
  EXPECT_TRUE(lattice.open(bytes, count));
  EXPECT_FALSE(lattice.open(bytes, count - 1));
  EXPECT_FALSE(lattice.open(bytes, count + 1));
  for (const std::size_t at : {std::size_t{0}, std::size_t{8}}) {
    for (const double bad : {0.0, -4.0, std::nan(""), static_cast<double>(INFINITY)}) {
      EXPECT_FALSE(lattice.open(with_number(bytes, at, bad), count)) << at << " " << bad;
    }
  }
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(lattice.open(cut, count)) << size;
  }
}

// For any bytes: rejected, or as many different boxes as cells.
TEST(cell_lattice, changed_bytes_make_boxes_or_errors) {
  random_source random(5);
  auto places = random_places(4, 150);
  std::erase_if(places, [](const lattice_place& p) { return p.level > 0; });
  const auto bytes = written(places);
  const auto count = static_cast<std::uint32_t>(places.size());
  int accepted = 0;
  for (int round = 0; round < 200000; ++round) {
    auto changed = bytes;
    for (int i = 0; i < 2; ++i) {
      std::byte& b = changed[random() % changed.size()];
      b ^= static_cast<std::byte>(1u << random() % 8);
    }
    cell_lattice lattice;
    if (!lattice.open(changed, count)) continue;
    ++accepted;
    std::vector<std::array<float, 3>> corners;
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      box b;
      ASSERT_TRUE(lattice.cell_box(cell, b));
      for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_LT(b.min[axis], b.max[axis]);
      corners.push_back({b.min[0], b.min[1], b.min[2]});
    }
    if (lattice.chunk(lattice.chunk_count() - 1).level > 0) continue;  // a position and its half may share a corner
    std::sort(corners.begin(), corners.end());
    ASSERT_EQ(std::adjacent_find(corners.begin(), corners.end()), corners.end());
  }
  EXPECT_GT(accepted, 300);
}

}  // namespace
