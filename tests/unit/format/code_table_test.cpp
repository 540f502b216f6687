#include "code_table.h"

#include <gtest/gtest.h>

#include <vector>

#include "code_table_writer.h"

namespace {

using namespace sightcell::format;

TEST(code_table, lengths_come_back_and_bytes_move_on) {
  symbol_lengths none{}, few{}, all{};
  few[0] = 1;
  few[9] = 15;
  all.fill(6);
  std::vector<std::byte> bytes;
  for (const symbol_lengths& lengths : {none, few, all}) put_code_lengths(lengths, bytes);
  EXPECT_EQ(bytes.size(), 1u + (1 + 5) + (1 + symbol_count / 2));
  EXPECT_EQ(bytes[1], std::byte{10});
  EXPECT_EQ(bytes[2], std::byte{0x01});
  EXPECT_EQ(bytes[6], std::byte{0xF0});
  std::span<const std::byte> left(bytes);
  for (const symbol_lengths& lengths : {none, few, all}) {
    symbol_lengths read{};
    ASSERT_TRUE(read_code_lengths(left, read));
    EXPECT_EQ(read, lengths);
  }
  EXPECT_TRUE(left.empty());
}

TEST(code_table, bytes_that_are_none) {
  symbol_lengths lengths{};
  std::vector<std::byte> bytes{std::byte{3}, std::byte{0x11}};  // three symbols need two bytes
  std::span<const std::byte> left(bytes);
  EXPECT_FALSE(read_code_lengths(left, lengths));
  EXPECT_EQ(left.size(), 2u);
  bytes.assign(200, std::byte{0x66});
  bytes[0] = static_cast<std::byte>(symbol_count + 1);
  left = bytes;
  EXPECT_FALSE(read_code_lengths(left, lengths));
  left = {};
  EXPECT_FALSE(read_code_lengths(left, lengths));
  bytes = {std::byte{2}, std::byte{0x22}};  // two codes of two bits are not whole
  left = bytes;
  prefix_code code;
  EXPECT_FALSE(read_code(left, code));
}

}  // namespace
