#include "prefix_code.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "code_lengths.h"
#include "random_source.h"

namespace {

using namespace sightcell::format;

TEST(number_symbols, every_number_has_one_symbol) {
  for (const std::uint64_t power : {0u, 1u, 2u, 3u, 4u, 8u, 9u, 10u, 15u, 20u, 31u, 32u}) {
    for (const std::int64_t beside : {-2, -1, 0, 1, 2}) {
      const std::int64_t wide = (std::int64_t{1} << power) + beside;
      if (wide < 0 || wide > 0xFFFFFFFF) continue;
      const auto value = static_cast<std::uint32_t>(wide);
      const number_symbol n = symbol_of(value);
      ASSERT_LT(n.symbol, symbol_count);
      EXPECT_EQ(n.raw_bits, raw_bits_of(n.symbol));
      EXPECT_EQ(base_of(n.symbol) + n.raw, value);
      EXPECT_EQ((head_of(n.symbol) << n.raw_bits | n.raw), value);
    }
  }
  for (std::uint32_t s = 1; s < symbol_count; ++s) EXPECT_LT(base_of(s - 1), base_of(s));
}

TEST(prefix_code, canonical_codes) {
  prefix_code code;
  const std::vector<std::uint8_t> lengths{2, 0, 1, 3, 3};
  ASSERT_TRUE(code.assign(lengths));
  // Shorter first, then by symbol: 2 is 0, 0 is 10, 3 is 110, 4 is 111; the first bit is the lowest one of a file.
  unsigned length = 0;
  EXPECT_EQ(code.decode(0b0, length), 2u);
  EXPECT_EQ(length, 1u);
  EXPECT_EQ(code.decode(0b01, length), 0u);
  EXPECT_EQ(length, 2u);
  EXPECT_EQ(code.decode(0b011, length), 3u);
  EXPECT_EQ(code.decode(0b111, length), 4u);
  EXPECT_EQ(length, 3u);
}

TEST(prefix_code, only_whole_codes) {
  const auto good = [](std::vector<std::uint8_t> lengths) { return prefix_code().assign(lengths); };
  EXPECT_TRUE(good({}));
  EXPECT_TRUE(good({0, 0, 0}));
  EXPECT_TRUE(good({0, 1}));   // a single one
  EXPECT_FALSE(good({0, 2}));  // a single one, longer than necessary
  EXPECT_TRUE(good({1, 1}));
  EXPECT_FALSE(good({1, 1, 1}));         // too many
  EXPECT_FALSE(good({1, 2}));            // no code begins with 11
  EXPECT_FALSE(good({1, 2, 3, 4, 16}));  // too long
  EXPECT_FALSE(good(std::vector<std::uint8_t>(symbol_count + 1, 7)));
  std::vector<std::uint8_t> all(symbol_count, 6);
  EXPECT_TRUE(good(all));
  std::vector<std::uint8_t> longest{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 15};
  EXPECT_TRUE(good(longest));
}

TEST(prefix_code, a_code_without_symbols_decodes_nothing) {
  unsigned length = 0;
  EXPECT_EQ(prefix_code().decode(0, length), prefix_code::no_symbol);
  prefix_code code;
  ASSERT_TRUE(code.assign(std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(code.decode(0, length), 1u);
  EXPECT_EQ(code.decode(1, length), prefix_code::no_symbol);
  EXPECT_FALSE(code.assign(std::vector<std::uint8_t>{1, 1, 1}));
  EXPECT_EQ(code.decode(0, length), prefix_code::no_symbol);
}

// Kraft's sum, and the bits of each symbol.
struct measured {
  std::uint64_t kraft = 0;  // in units of 2^-longest_code
  std::uint64_t bits = 0;
};

measured measure(const symbol_counts& counts, const symbol_lengths& lengths) {
  measured m;
  for (std::uint32_t s = 0; s < symbol_count; ++s) {
    if (lengths[s] > 0) m.kraft += std::uint64_t{1} << (longest_code - lengths[s]);
    m.bits += counts[s] * lengths[s];
  }
  return m;
}

TEST(code_lengths, small_codes) {
  symbol_counts counts{};
  EXPECT_EQ(best_lengths(counts), symbol_lengths{});
  counts[9] = 5;
  EXPECT_EQ(best_lengths(counts)[9], 1);
  counts[3] = 1;
  counts[4] = 1;
  const symbol_lengths lengths = best_lengths(counts);
  EXPECT_EQ(lengths[9], 1);
  EXPECT_EQ(lengths[3], 2);
  EXPECT_EQ(lengths[4], 2);
}

// Counts that grow like Fibonacci numbers give the longest Huffman codes; ours stop at longest_code.
TEST(code_lengths, never_longer_than_the_longest) {
  symbol_counts counts{};
  std::uint64_t a = 1, b = 1;
  for (std::uint32_t s = 0; s < 40; ++s) {
    counts[s] = a;
    const std::uint64_t next = a + b;
    a = b;
    b = next;
  }
  const symbol_lengths lengths = best_lengths(counts);
  EXPECT_EQ(*std::max_element(lengths.begin(), lengths.end()), longest_code);
  EXPECT_EQ(measure(counts, lengths).kraft, std::uint64_t{1} << longest_code);
  EXPECT_TRUE(prefix_code().assign(lengths));
}

// Huffman's own construction, which is optimal, where it needs no long codes.
std::uint64_t huffman_bits(const symbol_counts& counts) {
  std::vector<std::uint64_t> heap;
  for (const std::uint64_t c : counts) {
    if (c > 0) heap.push_back(c);
  }
  std::uint64_t bits = 0;
  while (heap.size() > 1) {
    std::sort(heap.begin(), heap.end(), std::greater<>());
    const std::uint64_t both = heap[heap.size() - 1] + heap[heap.size() - 2];
    heap.resize(heap.size() - 2);
    heap.push_back(both);
    bits += both;
  }
  return bits;
}

TEST(code_lengths, as_short_as_huffmans) {
  sightcell::test::random_source random(7);
  for (int round = 0; round < 200; ++round) {
    symbol_counts counts{};
    for (std::uint64_t& c : counts) c = random() % 3 == 0 ? 0 : 1 + random() % 1000;
    const symbol_lengths lengths = best_lengths(counts);
    const measured m = measure(counts, lengths);
    ASSERT_EQ(m.kraft, std::uint64_t{1} << longest_code);
    ASSERT_EQ(m.bits, huffman_bits(counts));
    prefix_code code;
    ASSERT_TRUE(code.assign(lengths));
    // Every code is decoded, with any bits after it.
    code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned length) {
      unsigned taken = 0;
      EXPECT_EQ(code.decode(bits | std::uint64_t{random()} << length, taken), symbol);
      EXPECT_EQ(taken, length);
    });
  }
}

}  // namespace
