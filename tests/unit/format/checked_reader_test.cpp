#include "checked_reader.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace {

using sightcell::format::checked_reader;
using sightcell::format::varint_cursor;

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int v : values) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

TEST(checked_reader, little_endian_at_any_alignment) {
  const auto bytes = bytes_of({0xFF, 1, 2, 3, 4, 5, 6, 7, 8, 0xFF});
  const checked_reader in(bytes);
  std::uint8_t a = 0;
  std::uint32_t b = 0;
  std::uint64_t c = 0;
  EXPECT_TRUE(in.read_u8(1, a) && in.read_u32(1, b) && in.read_u64(1, c));
  EXPECT_EQ(a, 1u);
  EXPECT_EQ(b, 0x04030201u);
  EXPECT_EQ(c, 0x0807060504030201u);
}

TEST(checked_reader, floats_are_bits) {
  const auto bytes = bytes_of({0, 0, 0x80, 0x3F, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F});
  const checked_reader in(bytes);
  float a = 0;
  double b = 0;
  EXPECT_TRUE(in.read_f32(0, a) && in.read_f64(4, b));
  EXPECT_EQ(a, 1.0f);
  EXPECT_EQ(b, 1.0);
}

TEST(checked_reader, nothing_is_read_past_the_end) {
  const std::vector<std::byte> bytes(8);
  const checked_reader in(bytes);
  std::uint32_t value = 7;
  for (const std::uint64_t at :
       {std::uint64_t{5}, std::uint64_t{8}, std::uint64_t{9}, std::numeric_limits<std::uint64_t>::max(),
        std::numeric_limits<std::uint64_t>::max() - 3}) {
    EXPECT_FALSE(in.read_u32(at, value)) << at;
  }
  EXPECT_EQ(value, 7u);
  EXPECT_TRUE(in.read_u32(4, value));
}

bool read_whole(std::initializer_list<int> values, std::uint32_t& out) {
  const auto bytes = bytes_of(values);
  varint_cursor in(bytes);
  return in.read(out) && in.at_end();
}

TEST(varint_cursor, values) {
  std::uint32_t value = 0;
  EXPECT_TRUE(read_whole({0}, value));
  EXPECT_EQ(value, 0u);
  EXPECT_TRUE(read_whole({0x7F}, value));
  EXPECT_EQ(value, 127u);
  EXPECT_TRUE(read_whole({0x80, 0x01}, value));
  EXPECT_EQ(value, 128u);
  EXPECT_TRUE(read_whole({0xFF, 0xFF, 0xFF, 0xFF, 0x0F}, value));
  EXPECT_EQ(value, 0xFFFFFFFFu);
}

TEST(varint_cursor, one_value_has_one_encoding) {
  std::uint32_t value = 0;
  EXPECT_FALSE(read_whole({0x80, 0x00}, value));
  EXPECT_FALSE(read_whole({0xFF, 0x80, 0x00}, value));
}

TEST(varint_cursor, too_large_and_too_long) {
  std::uint32_t value = 0;
  EXPECT_FALSE(read_whole({0xFF, 0xFF, 0xFF, 0xFF, 0x10}, value));
  EXPECT_FALSE(read_whole({0x80, 0x80, 0x80, 0x80, 0x80, 0x01}, value));
  EXPECT_FALSE(read_whole({}, value));
  EXPECT_FALSE(read_whole({0x80}, value));
}

TEST(varint_cursor, split_takes_no_more_than_there_is) {
  const auto bytes = bytes_of({1, 2, 3});
  varint_cursor in(bytes);
  varint_cursor head;
  EXPECT_FALSE(in.split(4, head));
  EXPECT_TRUE(in.split(2, head));
  EXPECT_EQ(head.left(), 2u);
  EXPECT_EQ(in.left(), 1u);
}

}  // namespace
