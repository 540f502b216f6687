#include "bit_reader.h"

#include <gtest/gtest.h>

#include <vector>

#include "bit_sink.h"
#include "random_source.h"

namespace {

using namespace sightcell::format;

// In memory of exactly this size, so that the sanitizer detects a load after its end.
std::vector<std::byte> padded(std::vector<std::byte> bytes) {
  bytes.resize(bytes.size() + bit_reader::padding);
  bytes.shrink_to_fit();
  return bytes;
}

struct number {
  std::uint32_t value = 0;
  unsigned bits = 0;
};

std::vector<number> random_numbers(std::uint32_t seed, std::size_t count) {
  sightcell::test::random_source random(seed);
  std::vector<number> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned bits = random() % 33;
    numbers.push_back({bits == 0 ? 0 : random() >> (32 - bits), bits});
  }
  return numbers;
}

std::vector<std::byte> written(const std::vector<number>& numbers) {
  std::vector<std::byte> bytes;
  bit_sink sink(bytes);
  for (const number& n : numbers) sink.put(n.value, n.bits);
  sink.align();
  return padded(bytes);
}

TEST(bit_reader, lowest_bit_of_a_byte_comes_first) {
  std::vector<std::byte> bytes;
  bit_sink sink(bytes);
  sink.put(0b101, 3);
  sink.put(0b11111, 5);
  sink.put(0x3, 2);
  sink.align();
  ASSERT_EQ(bytes.size(), 2u);
  EXPECT_EQ(bytes[0], std::byte{0xFD});
  EXPECT_EQ(bytes[1], std::byte{0x03});
}

TEST(bit_reader, takes_what_was_put) {
  const auto numbers = random_numbers(1, 5000);
  const auto bytes = written(numbers);
  bit_reader in(bytes);
  for (const number& n : numbers) ASSERT_EQ(in.take(n.bits), n.value);
  EXPECT_FALSE(in.beyond_end());
  in.skip(8);
  EXPECT_TRUE(in.beyond_end());
}

TEST(bit_reader, seek_goes_anywhere) {
  const auto numbers = random_numbers(2, 100);
  const auto bytes = written(numbers);
  std::uint64_t place = 0;
  for (const number& n : numbers) {
    bit_reader in(bytes);
    in.seek(place);
    EXPECT_EQ(in.take(n.bits), n.value);
    place += n.bits;
  }
}

TEST(bit_reader, behind_the_end_nothing_is_read) {
  const std::vector<std::byte> few(7, std::byte{0xFF});
  bit_reader none{few};
  EXPECT_EQ(none.peek(), 0u);
  EXPECT_FALSE(none.beyond_end());
  EXPECT_EQ(none.take(1), 0u);
  EXPECT_TRUE(none.beyond_end());

  const auto bytes = padded({std::byte{0xFF}});
  bit_reader in{bytes};
  in.seek(std::uint64_t{1} << 40);
  EXPECT_EQ(in.peek(), 0u);
  EXPECT_TRUE(in.beyond_end());
  EXPECT_TRUE(bit_reader().peek() == 0 && !bit_reader().beyond_end());
}

TEST(bit_buffer, gives_the_bits_of_the_reader) {
  const auto numbers = random_numbers(3, 5000);
  const auto bytes = written(numbers);
  for (const std::size_t begin : {0u, 1u, 17u}) {
    bit_reader in(bytes);
    for (std::size_t i = 0; i < begin; ++i) in.skip(numbers[i].bits);
    bit_buffer held(in);
    for (std::size_t i = begin; i < numbers.size(); ++i) {
      held.fill();
      ASSERT_GE(held.left(), bit_reader::peek_bits);
      ASSERT_EQ(held.place(), in.place());
      ASSERT_EQ(held.bits() & ((std::uint64_t{1} << numbers[i].bits) - 1), numbers[i].value);
      held.skip(numbers[i].bits);
      in.skip(numbers[i].bits);
    }
    EXPECT_EQ(held.place(), in.place());
  }
}

TEST(bit_buffer, after_the_end_come_zeros_and_the_position_is_beyond_it) {
  const auto bytes = padded({std::byte{0xFF}, std::byte{0xFF}});
  bit_buffer held{bit_reader(bytes)};
  for (int i = 0; i < 100; ++i) {
    held.fill();
    held.skip(50);
  }
  bit_reader in(bytes);
  in.seek(held.place());
  EXPECT_EQ(held.place(), 5000u);
  EXPECT_TRUE(in.beyond_end());

  bit_buffer nothing{bit_reader()};
  nothing.fill();
  EXPECT_EQ(nothing.bits(), 0u);
  nothing.skip(56);
  EXPECT_EQ(nothing.place(), 56u);
}

}  // namespace
