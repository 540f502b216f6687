#include "run_code.h"

#include <gtest/gtest.h>

#include <vector>

#include "random_source.h"
#include "run_encoder.h"
#include "run_lists.h"
#include "unit/case_step.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

// Ascending, disjoint, not touching. scale: the size of gaps and lengths.
std::vector<run> random_runs(random_source& random, std::size_t count, std::uint32_t scale) {
  std::vector<run> runs;
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t first = next + random() % (1 + random() % scale);
    const std::uint64_t length = 1 + random() % (1 + random() % scale);
    if (first + length >= 0xFFFFFFFE) break;
    runs.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(length)});
    next = first + length + 1;
  }
  return runs;
}

struct coder {
  explicit coder(const std::vector<run>& runs) : encoder(counts_of(runs)) {
    EXPECT_TRUE(code.assign(encoder.gap_lengths(), encoder.more_lengths()));
  }
  static run_counts counts_of(const std::vector<run>& runs) {
    run_counts counts;
    counts.add(runs);
    return counts;
  }
  [[nodiscard]] std::vector<std::byte> encode(const std::vector<run>& runs) const {
    std::vector<std::byte> bytes;
    bit_sink sink(bytes);
    encoder.encode(runs, sink);
    sink.align();
    EXPECT_EQ(bytes.size(), (encoder.size(runs) + 7) / 8);
    bytes.resize(bytes.size() + bit_reader::padding);
    bytes.shrink_to_fit();
    return bytes;
  }

  run_encoder encoder;
  run_code code;
};

constexpr std::uint32_t limit = 0xFFFFFFFE;

TEST(run_code, what_was_encoded_comes_back) {
  random_source random(1);
  for (const std::uint32_t scale : {1u, 2u, 5u, 30u, 1000u, 100'000u, 0x40000000u}) {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 7u, 1000u}) {
      const std::vector<run> runs = random_runs(random, count, scale);
      const coder c(runs);
      const auto bytes = c.encode(runs);
      bit_reader in(bytes);
      std::vector<std::uint32_t> out(2 * runs.size());
      ASSERT_TRUE(c.code.decode(in, static_cast<std::uint32_t>(runs.size()), limit, out));
      EXPECT_EQ(out, borders_of(runs));
      EXPECT_EQ(in.place(), c.encoder.size(runs));
    }
  }
}

// Two lists in sequence, starting inside a byte.
TEST(run_code, lists_follow_each_other) {
  random_source random(2);
  const std::vector<run> a = random_runs(random, 50, 40), b = random_runs(random, 31, 9000);
  std::vector<run> both = a;
  both.insert(both.end(), b.begin(), b.end());
  run_counts counts;
  counts.add(a);
  counts.add(b);
  const run_encoder encoder(counts);
  run_code code;
  ASSERT_TRUE(code.assign(encoder.gap_lengths(), encoder.more_lengths()));
  std::vector<std::byte> bytes;
  bit_sink sink(bytes);
  sink.put(5, 3);
  encoder.encode(a, sink);
  encoder.encode(b, sink);
  sink.align();
  bytes.resize(bytes.size() + bit_reader::padding);
  bit_reader in(bytes);
  EXPECT_EQ(in.take(3), 5u);
  std::vector<std::uint32_t> out(2 * a.size());
  ASSERT_TRUE(code.decode(in, static_cast<std::uint32_t>(a.size()), limit, out));
  EXPECT_EQ(out, borders_of(a));
  out.resize(2 * b.size());
  ASSERT_TRUE(code.decode(in, static_cast<std::uint32_t>(b.size()), limit, out));
  EXPECT_EQ(out, borders_of(b));
}

TEST(run_code, runs_stay_below_the_limit) {
  const std::vector<run> runs{{2, 3}, {8, 2}};
  const coder c(runs);
  const auto bytes = c.encode(runs);
  std::vector<std::uint32_t> out(4);
  bit_reader in(bytes);
  EXPECT_TRUE(c.code.decode(in, 2, 10, out));
  in = bit_reader(bytes);
  EXPECT_FALSE(c.code.decode(in, 2, 9, out));
  in = bit_reader(bytes);
  out.resize(3);
  EXPECT_FALSE(c.code.decode(in, 2, 10, out));  // no room
}

TEST(run_code, bits_end_where_the_list_ends) {
  random_source random(3);
  const std::vector<run> runs = random_runs(random, 40, 3000);
  const coder c(runs);
  const auto bytes = c.encode(runs);
  std::vector<std::uint32_t> out(2 * runs.size());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    bit_reader in(cut);
    EXPECT_FALSE(c.code.decode(in, static_cast<std::uint32_t>(runs.size()), limit, out)) << size;
  }
}

TEST(run_code, codes_that_are_none) {
  run_code code;
  const std::vector<std::uint8_t> good{1, 1}, bad{1, 1, 1}, none;
  EXPECT_FALSE(code.assign(good, bad));
  EXPECT_FALSE(code.assign(bad, good));
  const std::vector<std::byte> bytes(16);
  std::vector<std::uint32_t> out(2);
  bit_reader in(bytes);
  EXPECT_FALSE(code.decode(in, 1, 10, out));
  EXPECT_TRUE(code.decode(in, 0, 10, out));
  ASSERT_TRUE(code.assign(none, none));
  EXPECT_FALSE(code.decode(in, 1, 10, out));
}

// For any bits, an accepted list is a set below the limit.
TEST(run_code, random_bits_make_sets_or_errors) {
  random_source random(4);
  int accepted = 0;
  for (std::size_t round = 0; round < 20000; round += case_step()) {
    const coder c(random_runs(random, 30, 1 + random() % 200));
    std::vector<std::byte> bytes(8 + random() % 20);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random() & random());
    bit_reader in(bytes);
    std::vector<std::uint32_t> out(2 * (random() % 9));
    const auto count = static_cast<std::uint32_t>(random() % 9);
    if (!c.code.decode(in, count, 500, out)) continue;
    ++accepted;
    std::int64_t last = -1;
    for (std::uint32_t i = 0; i < 2 * count; ++i) {
      ASSERT_GT(out[i], last);
      last = out[i];
    }
    ASSERT_LE(last, 500);
  }
  EXPECT_GT(accepted, 1000 / static_cast<int>(case_step()));
}

}  // namespace
