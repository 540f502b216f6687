#include "row_chunk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "random_source.h"
#include "row_chunk_encoder.h"
#include "run_lists.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using set_list = std::vector<std::vector<run>>;

constexpr std::uint32_t limit = 2000;

// Sets that resemble the one before, a few equal, one empty and one full.
set_list like_sets(std::uint32_t seed, std::size_t count) {
  random_source random(seed);
  std::vector<bool> members(limit);
  set_list sets;
  for (std::size_t cell = 0; cell < count; ++cell) {
    for (std::uint32_t i = 0; i < limit; ++i) {
      if (random() % 12 == 0) members[i] = i > 0 && random() % 5 != 0 ? members[i - 1] : random() % 4 == 0;
    }
    sets.push_back(runs_of(members));
    if (cell % 9 == 8) sets.back() = sets[cell / 2];
    if (cell == 5) sets.back().clear();
    if (cell == 6) sets.back() = {{0, limit}};
  }
  return sets;
}

// A chunk with everything that decoding needs.
struct coded {
  chunk_plan plan;
  row_codes codes;
  row_bounds bounds;
  std::vector<std::byte> bytes;
};

coded encode(const set_list& sets) {
  row_counts first;
  for (const auto& set : sets) first.own.add(set);
  first.removed = first.added = first.own;
  coded c;
  c.plan = plan_chunk(sets, row_encoders(first), limit);
  const auto backward = [](std::size_t count, const std::function<void(std::size_t)>& work) {
    while (count > 0) work(--count);
  };
  const chunk_plan at_once = plan_chunk(sets, row_encoders(first), limit, {.run_at_once = backward});
  EXPECT_EQ(at_once.same, c.plan.same);
  EXPECT_EQ(at_once.reference, c.plan.reference);
  row_counts counts;
  count_chunk(sets, c.plan, counts);
  const row_encoders encoders(counts);
  encode_chunk(sets, c.plan, encoders, c.bytes);
  c.bytes.shrink_to_fit();
  EXPECT_TRUE(c.codes.own.assign(encoders.own.gap_lengths(), encoders.own.more_lengths()));
  EXPECT_TRUE(c.codes.removed.assign(encoders.removed.gap_lengths(), encoders.removed.more_lengths()));
  EXPECT_TRUE(c.codes.added.assign(encoders.added.gap_lengths(), encoders.added.more_lengths()));
  c.bounds = {limit, 0, counts.list_runs};
  for (const auto& set : sets) c.bounds.runs = std::max(c.bounds.runs, static_cast<std::uint32_t>(set.size()));
  return c;
}

struct decoded {
  status outcome = status::ok;
  std::vector<std::uint32_t> borders;
  std::uint64_t end = 0;
};

decoded decode(const coded& c, std::span<const std::byte> bytes, std::uint32_t rows, std::uint32_t place) {
  row_chunk chunk;
  if (!chunk.open(bytes, rows)) return {status::corrupt, {}, 0};
  std::vector<std::uint32_t> scratch(c.bounds.scratch_room());
  std::span<const std::uint32_t> borders;
  decoded d;
  d.outcome = chunk.decode(place, c.codes, c.bounds, scratch, borders, d.end);
  d.borders.assign(borders.begin(), borders.end());
  return d;
}

TEST(row_chunk, every_set_comes_back) {
  for (const std::size_t count : {1u, 2u, 17u, 64u}) {
    const set_list sets = like_sets(static_cast<std::uint32_t>(count), count);
    const coded c = encode(sets);
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      const decoded d = decode(c, c.bytes, static_cast<std::uint32_t>(count), cell);
      ASSERT_EQ(d.outcome, status::ok);
      ASSERT_EQ(d.borders, borders_of(sets[cell]));
    }
  }
}

TEST(row_chunk, has_every_kind_of_row_and_they_fill_it) {
  const set_list sets = like_sets(3, 64);
  const coded c = encode(sets);
  row_chunk chunk;
  ASSERT_TRUE(chunk.open(c.bytes, 64));
  std::size_t own = 0, deltas = 0, shared = 0, deepest = 0;
  std::uint64_t next = 0;
  for (std::uint32_t cell = 0; cell < 64; ++cell) {
    row_head head;
    ASSERT_TRUE(chunk.head(cell, head));
    if (chunk.begin_of(cell) != next) {
      ++shared;
      EXPECT_LT(chunk.begin_of(cell), next);
      continue;
    }
    next = decode(c, c.bytes, 64, cell).end;
    ++(head.delta ? deltas : own);
    std::size_t depth = 0;
    for (row_head above = head; above.delta; ++depth) ASSERT_TRUE(chunk.head(above.reference, above));
    deepest = std::max(deepest, depth);
  }
  EXPECT_EQ(next, chunk.end_of_rows());
  EXPECT_GT(own, 0u);
  EXPECT_GT(deltas, 20u);
  EXPECT_EQ(shared, 7u);
  EXPECT_EQ(deepest, layout::max_reference_depth);
  EXPECT_EQ(chunk.begin_of(64), next);
}

TEST(row_chunk, the_same_sets_make_the_same_bytes) {
  EXPECT_EQ(encode(like_sets(4, 40)).bytes, encode(like_sets(4, 40)).bytes);
}

TEST(row_chunk, differences_save_bits) {
  const set_list sets = like_sets(5, 64);
  const coded c = encode(sets);
  row_counts counts;
  chunk_plan alone = c.plan;
  std::fill(alone.reference.begin(), alone.reference.end(), chunk_plan::alone);
  count_chunk(sets, alone, counts);
  std::vector<std::byte> without;
  encode_chunk(sets, alone, row_encoders(counts), without);
  EXPECT_LT(c.bytes.size(), without.size() * 8 / 10);
}

TEST(row_chunk, bounds_are_kept) {
  const set_list sets = like_sets(6, 64);
  coded c = encode(sets);
  const auto all_good = [&] {
    for (std::uint32_t cell = 0; cell < 64; ++cell) {
      if (decode(c, c.bytes, 64, cell).outcome != status::ok) return false;
    }
    return true;
  };
  EXPECT_TRUE(all_good());
  const row_bounds right = c.bounds;
  --c.bounds.runs;
  EXPECT_FALSE(all_good());
  c.bounds = right;
  --c.bounds.list_runs;
  EXPECT_FALSE(all_good());
  c.bounds = right;
  --c.bounds.limit;
  EXPECT_FALSE(all_good());
  c.bounds = right;
  row_chunk chunk;
  ASSERT_TRUE(chunk.open(c.bytes, 64));
  std::vector<std::uint32_t> scratch(right.scratch_room() - 1);
  std::span<const std::uint32_t> borders;
  std::uint64_t end = 0;
  EXPECT_EQ(chunk.decode(0, c.codes, right, scratch, borders, end), status::capacity);
}

// With lists, the room of a set is larger than its bound; the bound still holds.
TEST(row_chunk, own_rows_keep_the_bound_of_runs) {
  coded c = encode({{{0, 1}, {5, 2}, {9, 1}}});
  c.bounds.list_runs = 5;
  EXPECT_EQ(decode(c, c.bytes, 1, 0).outcome, status::ok);
  --c.bounds.runs;
  EXPECT_EQ(decode(c, c.bytes, 1, 0).outcome, status::corrupt);
}

TEST(row_chunk, chains_and_circles_of_references) {
  // Rows that are differences without lists: 1, index, no runs, no runs.
  const auto chunk_of = [](const std::vector<std::uint32_t>& references) {
    std::vector<std::byte> rows, bytes;
    bit_sink bits(rows);
    for (const std::uint32_t reference : references) {
      const bool delta = reference < 64;
      bits.put(delta ? 1 : 0, 1);
      if (delta) bits.put(reference, 6);
      bits.put(0, delta ? 10 : 5);
      bits.align();
    }
    bit_sink table(bytes);
    table.put(8, 8);
    std::uint32_t place = 0;
    for (const std::uint32_t reference : references) {
      table.put(place, 8);
      place += reference < 64 ? 3 : 1;
    }
    table.align();
    bytes.insert(bytes.end(), rows.begin(), rows.end());
    bytes.resize(bytes.size() + bit_reader::padding);
    return bytes;
  };
  coded c;
  c.bounds = {10, 1, 1};
  const auto outcome = [&](const std::vector<std::uint32_t>& references, std::uint32_t place) {
    return decode(c, chunk_of(references), static_cast<std::uint32_t>(references.size()), place).outcome;
  };
  constexpr std::uint32_t own = 64;
  EXPECT_EQ(outcome({own, 0, 1}, 2), status::ok);
  EXPECT_EQ(outcome({own, 0, 1, 2}, 3), status::corrupt);  // one too deep
  EXPECT_EQ(outcome({0}, 0), status::corrupt);             // itself
  EXPECT_EQ(outcome({1, 0}, 0), status::corrupt);
  EXPECT_EQ(outcome({own, 5}, 1), status::corrupt);  // no such row
}

TEST(row_chunk, cut_at_every_length) {
  const set_list sets = like_sets(7, 12);
  const coded c = encode(sets);
  for (std::size_t size = 0; size < c.bytes.size(); ++size) {
    const std::vector<std::byte> cut(c.bytes.begin(), c.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    bool all = true;
    for (std::uint32_t cell = 0; cell < 12; ++cell) all = all && decode(c, cut, 12, cell).outcome == status::ok;
    EXPECT_FALSE(all) << size;
  }
}

// For any bytes, an accepted row is a set that keeps the bounds.
TEST(row_chunk, changed_bytes_make_sets_or_errors) {
  const set_list sets = like_sets(8, 20);
  const coded c = encode(sets);
  random_source random(9);
  std::size_t accepted = 0;
  for (int round = 0; round < 4000; ++round) {
    auto bytes = c.bytes;
    for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    const decoded d = decode(c, bytes, 20, random() % 20);
    if (d.outcome != status::ok) continue;
    ++accepted;
    ASSERT_LE(d.borders.size(), 2 * std::size_t{c.bounds.runs});
    std::int64_t last = -1;
    for (const std::uint32_t border : d.borders) {
      ASSERT_GT(border, last);
      last = border;
    }
    ASSERT_LE(last, limit);
  }
  EXPECT_GT(accepted, 500u);
}

}  // namespace
