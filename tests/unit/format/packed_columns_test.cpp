#include "sightcell/format/packed_columns.h"

#include <gtest/gtest.h>

#include <vector>

#include "packed_columns_writer.h"
#include "random_source.h"

namespace {

using namespace sightcell::format;
using table = std::vector<std::vector<std::uint32_t>>;

// In memory of exactly this size, so that the sanitizer detects a load after its end.
std::vector<std::byte> written(const table& columns) {
  std::vector<std::byte> bytes;
  put_columns(columns, bytes);
  bytes.shrink_to_fit();
  return bytes;
}

TEST(packed_columns, every_value_is_found) {
  sightcell::test::random_source random(1);
  for (const std::uint32_t rows : {0u, 1u, 7u, 200u}) {
    table columns(9);
    for (std::uint32_t c = 0; c < columns.size(); ++c) {
      const std::uint32_t base = c == 8 ? 0 : random() % 1000;
      for (std::uint32_t i = 0; i < rows; ++i) columns[c].push_back(base + (c == 0 ? 0 : random() >> (32 - 4 * c)));
    }
    const auto bytes = written(columns);
    packed_columns packed;
    ASSERT_TRUE(packed.open(bytes, 9, rows));
    for (std::uint32_t c = 0; c < columns.size(); ++c) {
      const packed_column column(packed, c);
      for (std::uint32_t i = 0; i < rows; ++i) ASSERT_EQ(column[i], columns[c][i]);
    }
  }
}

TEST(packed_columns, equal_values_take_no_bits) {
  const table columns{std::vector<std::uint32_t>(1000, 77), std::vector<std::uint32_t>(1000, 0xFFFFFFFF)};
  EXPECT_EQ(written(columns).size(), 2 * packed_columns::descriptor_size);
}

TEST(packed_columns, as_few_bits_as_the_values_need) {
  table columns{{1000, 1003, 1001, 1002, 1000}};
  EXPECT_EQ(written(columns).size(), packed_columns::descriptor_size + 2);  // 5 values of 2 bits
  columns[0].back() = 1004;
  EXPECT_EQ(written(columns).size(), packed_columns::descriptor_size + 2);  // 5 of 3
  columns[0].push_back(1000);
  EXPECT_EQ(written(columns).size(), packed_columns::descriptor_size + 3);  // 6 of 3
}

TEST(packed_columns, the_size_must_fit) {
  const table columns{{1, 2, 3}, {100, 5000, 70}};
  auto bytes = written(columns);
  packed_columns packed;
  std::uint64_t size = 0;
  EXPECT_TRUE(packed_columns::size_of(bytes, 2, 3, size));
  EXPECT_EQ(size, bytes.size());
  EXPECT_FALSE(packed.open(bytes, 2, 30));
  EXPECT_FALSE(packed.open(bytes, 1, 3));
  EXPECT_FALSE(packed.open(bytes, 20, 3));
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(packed.open(bytes, 2, 3));
  EXPECT_TRUE(packed_columns::size_of(bytes, 2, 3, size));
  EXPECT_EQ(size, bytes.size() - 1);
  for (std::size_t left = 0; left + 1 < bytes.size(); ++left) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(left));
    EXPECT_FALSE(packed.open(cut, 2, 3)) << left;
    EXPECT_FALSE(packed_columns::size_of(cut, 2, 3, size)) << left;
  }
  bytes = written(columns);
  bytes[4] = std::byte{33};
  EXPECT_FALSE(packed.open(bytes, 2, 3));
}

TEST(packed_columns, what_there_is_not_is_zero) {
  const auto bytes = written({{5, 6}});
  packed_columns packed;
  ASSERT_TRUE(packed.open(bytes, 1, 2));
  EXPECT_EQ(packed_column(packed, 0)[1], 6u);
  EXPECT_EQ(packed_column(packed, 0)[2], 0u);
  EXPECT_EQ(packed_column(packed, 1)[0], 0u);
  EXPECT_EQ(packed_column()[0], 0u);
}

// The bytes change while they are open.
TEST(packed_columns, bytes_that_change_stay_inside) {
  sightcell::test::random_source random(3);
  for (int round = 0; round < 3000; ++round) {
    auto bytes = written({{1, 2, 3, 900}, {4, 4, 4, 5}});
    packed_columns packed;
    ASSERT_TRUE(packed.open(bytes, 2, 4));
    const packed_column before(packed, 1);
    for (int i = 0; i < 4; ++i) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    const packed_column after(packed, 1);
    for (std::uint32_t row = 0; row < 5; ++row) {
      (void)before[row];
      (void)after[row];
    }
  }
}

}  // namespace
