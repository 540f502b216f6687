#include "row_decoder.h"

#include <gtest/gtest.h>

#include <vector>

#include "random_source.h"

namespace {

using namespace sightcell::format;

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int v : values) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

struct decoded {
  status outcome = status::ok;
  std::vector<run> runs;
};

// Decodes into a buffer of exactly room runs, so that the sanitizer detects any write after it.
decoded decode(std::span<const std::byte> bytes, std::uint32_t polygons, std::span<const run> reference,
               std::size_t room) {
  decoded answer;
  const std::vector<std::byte> exact(bytes.begin(), bytes.end());
  row_header header;
  if (!read_row_header(exact, header)) return {status::corrupt, {}};
  answer.runs.resize(room);
  std::size_t count = 0;
  answer.outcome = header.delta ? decode_delta_row(header, polygons, reference, answer.runs, count)
                                : decode_own_row(header, polygons, answer.runs, count);
  EXPECT_TRUE(answer.outcome == status::ok || count == 0);
  answer.runs.resize(count);
  return answer;
}

TEST(row_decoder, own_row) {
  // Two runs: gap 0, length 3; then (one polygon between) gap 0, length 1.
  const decoded row = decode(bytes_of({2 << 1, 0, 2, 0, 0}), 10, {}, 2);
  ASSERT_EQ(row.outcome, status::ok);
  ASSERT_EQ(row.runs.size(), 2u);
  EXPECT_EQ(row.runs[0].first, 0u);
  EXPECT_EQ(row.runs[0].count, 3u);
  EXPECT_EQ(row.runs[1].first, 4u);
  EXPECT_EQ(row.runs[1].count, 1u);
}

TEST(row_decoder, own_row_faults) {
  EXPECT_EQ(decode({}, 10, {}, 9).outcome, status::corrupt);                              // no header
  EXPECT_EQ(decode(bytes_of({2 << 1, 0, 2}), 10, {}, 9).outcome, status::corrupt);        // a run is missing
  EXPECT_EQ(decode(bytes_of({1 << 1, 0, 2, 0}), 10, {}, 9).outcome, status::corrupt);     // a byte too many
  EXPECT_EQ(decode(bytes_of({1 << 1, 0, 10}), 10, {}, 9).outcome, status::corrupt);       // after the last polygon
  EXPECT_EQ(decode(bytes_of({1 << 1, 0, 9}), 10, {}, 9).outcome, status::ok);             // all polygons
  EXPECT_EQ(decode(bytes_of({2 << 1, 0, 2, 0, 0}), 10, {}, 1).outcome, status::corrupt);  // more runs than room
  EXPECT_EQ(decode(bytes_of({1 << 1, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F}), 0xFFFFFFFEu, {}, 9)
                .outcome,
            status::corrupt);  // sums above 32 bits do not wrap
}

TEST(row_decoder, delta_row) {
  const std::vector<run> reference{{0, 5}, {10, 5}};
  // Removes 1..2 and 10..14, adds 5..6 (touches what is kept) and 20.
  const auto bytes = bytes_of({2 << 1 | 1, 3, 2, 4, 1, 1, 6, 4, 5, 1, 12, 0});
  const decoded row = decode(bytes, 30, reference, 3);
  ASSERT_EQ(row.outcome, status::ok);
  ASSERT_EQ(row.runs.size(), 3u);
  EXPECT_EQ(row.runs[1].first, 3u);
  EXPECT_EQ(row.runs[1].count, 4u);
  EXPECT_EQ(row.runs[2].first, 20u);
  EXPECT_EQ(decode(bytes, 30, reference, 2).outcome, status::corrupt);  // more runs than room
}

TEST(row_decoder, delta_row_faults) {
  const std::vector<run> reference{{2, 3}};
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 0, 0, 2, 2, 2}), 10, reference, 9).outcome, status::ok);
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 64, 0, 2, 2, 2}), 10, reference, 9).outcome,
            status::corrupt);                                                                           // no such cell
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 0, 0, 2, 1, 2}), 10, reference, 9).outcome, status::corrupt);  // removes 1
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 0, 0, 2, 2, 3}), 10, reference, 9).outcome, status::corrupt);  // removes 5
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 0, 0, 2, 7, 0}), 10, reference, 9).outcome, status::corrupt);  // removes 7
  EXPECT_EQ(decode(bytes_of({0 << 1 | 1, 0, 1, 0, 1, 1}), 10, reference, 9).outcome, status::corrupt);  // adds 2 twice
  EXPECT_EQ(decode(bytes_of({0 << 1 | 1, 0, 1, 0, 4, 0}), 10, reference, 9).outcome, status::corrupt);  // adds 4 twice
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 0, 0, 3, 2, 2}), 10, reference, 9).outcome,
            status::corrupt);  // split too long
  EXPECT_EQ(decode(bytes_of({1 << 1 | 1, 0, 0, 2, 2, 2, 0}), 10, reference, 9).outcome, status::corrupt);  // byte left
}

// For any bytes, an accepted row is a set inside the scene.
TEST(row_decoder, random_bytes_make_sets_or_errors) {
  sightcell::test::random_source random(5);
  const std::vector<run> reference{{3, 4}, {20, 30}, {60, 1}};
  int accepted = 0;
  for (int round = 0; round < 200000; ++round) {
    std::vector<std::byte> bytes(random() % 14);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random() % 4 == 0 ? random() : random() % 8);
    const decoded row = decode(bytes, 100, reference, 6);
    if (row.outcome != status::ok) continue;
    ++accepted;
    std::uint64_t next = 0;
    for (const run& r : row.runs) {
      ASSERT_GE(r.first, next);
      ASSERT_GE(r.count, 1u);
      next = std::uint64_t{r.first} + r.count + 1;
      ASSERT_LE(next, 101u);
    }
  }
  EXPECT_GT(accepted, 1000);
}

}  // namespace
