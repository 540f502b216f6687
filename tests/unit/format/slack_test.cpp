#include "slack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "random_source.h"
#include "range_borders.h"
#include "run_lists.h"
#include "sightcell/format/draw_ranges.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;
using set_list = std::vector<std::vector<run>>;

constexpr std::uint32_t limit = 3000;
constexpr std::uint64_t plenty = 1000000;

// Polygons of each draw: small ones and an empty one among large ones.
std::vector<draw_record> some_draws() {
  std::vector<draw_record> draws;
  std::uint32_t next = 0;
  for (const std::uint32_t count : {700u, 3u, 0u, 1u, 996u, 300u, 1000u}) {
    draws.push_back({.first_source = next, .polygon_count = count, .first_stored = next});
    next += count;
  }
  EXPECT_EQ(next, limit);
  return draws;
}

std::vector<std::uint32_t> some_borders() {
  return range_borders(some_draws(), host_layout::instanced);
}

// Sets that resemble the one before, with gaps; a few equal, some empty, one full.
set_list like_sets(std::uint32_t seed, std::size_t count) {
  random_source random(seed);
  std::vector<bool> members(limit);
  set_list sets;
  for (std::size_t cell = 0; cell < count; ++cell) {
    for (std::uint32_t i = 0; i < limit; ++i) {
      if (cell > 0 && random() % 12 != 0) continue;
      members[i] = i > 0 && random() % 5 != 0 ? members[i - 1] : random() % 4 == 0;
    }
    sets.push_back(runs_of(members));
    if (cell % 9 == 8) sets.back() = sets[cell / 2];
    if (cell % 40 == 5) sets.back().clear();
    if (cell % 40 == 6) sets.back() = {{0, limit}};
    if (cell % 40 == 7) sets.back() = {{1, 10}};
  }
  return sets;
}

std::uint64_t polygons_of(const std::vector<run>& set) {
  std::uint64_t sum = 0;
  for (const run& r : set) sum += r.count;
  return sum;
}

std::uint64_t ranges_of(const set_list& sets) {
  const auto draws = some_draws();
  std::uint64_t ranges = 0;
  for (const auto& set : sets) {
    for_each_draw_range(
        set, static_cast<std::uint32_t>(draws.size()), limit, [&](std::uint32_t d) { return draws[d].first_stored; },
        [&](std::uint32_t, std::uint32_t, std::uint32_t) { ++ranges; });
  }
  return ranges;
}

std::uint64_t runs_of_all(const set_list& sets) {
  std::uint64_t runs = 0;
  for (const auto& set : sets) runs += set.size();
  return runs;
}

std::vector<bool> members_of(const std::vector<run>& set) {
  std::vector<bool> members(limit);
  for (const run& r : set) std::fill_n(members.begin() + r.first, r.count, true);
  return members;
}

bool holds_all_of(const std::vector<run>& large, const std::vector<run>& small) {
  const std::vector<bool> members = members_of(large);
  return std::all_of(small.begin(), small.end(), [&](const run& r) {
    return std::all_of(members.begin() + r.first, members.begin() + r.first + r.count, [](bool in) { return in; });
  });
}

// Each cell keeps its polygons and its budget.
void expect_supersets(const set_list& widened, const set_list& sets, std::uint64_t share) {
  ASSERT_EQ(widened.size(), sets.size());
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    EXPECT_TRUE(holds_all_of(widened[cell], sets[cell])) << cell;
    const std::uint64_t seen = polygons_of(sets[cell]);
    EXPECT_LE(polygons_of(widened[cell]), seen + seen * share / slack_share_unit) << cell;
  }
}

// ---- The path of one cell.

slack_column seen(std::uint32_t size) {
  return {.size = size, .seen = true};
}
slack_column gap(std::uint32_t size) {
  return {.size = size};
}

constexpr slack_prices flat{10 * slack_price_unit, 10 * slack_price_unit, 10 * slack_price_unit, 0};

// The polygons of the columns that are drawn without being in the set.
std::uint64_t chosen(const std::vector<slack_column>& columns, bool alone, std::uint64_t budget,
                     const slack_prices& prices, std::vector<bool>& drawn) {
  slack_path(prices).choose(columns, alone, budget, drawn);
  EXPECT_EQ(drawn.size(), columns.size());
  std::uint64_t added = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    EXPECT_TRUE(drawn[i] || !columns[i].seen) << i;
    if (drawn[i] && !columns[i].seen) added += columns[i].size;
  }
  EXPECT_LE(added, budget);
  return added;
}

TEST(slack_path, fills_the_smallest_gaps) {
  const std::vector<slack_column> columns{gap(5), seen(9), gap(3), seen(1), gap(1), seen(2), gap(2), seen(8)};
  std::vector<bool> drawn;
  EXPECT_EQ(chosen(columns, true, 0, flat, drawn), 0u);
  EXPECT_EQ(chosen(columns, true, 1, flat, drawn), 1u);
  EXPECT_TRUE(drawn[4]);
  EXPECT_EQ(chosen(columns, true, 4, flat, drawn), 3u);
  EXPECT_TRUE(drawn[4] && drawn[6]);
  EXPECT_EQ(chosen(columns, true, plenty, flat, drawn), 6u);
  EXPECT_FALSE(drawn[0]) << "saves nothing";
}

// All gaps have the same price: no price is low enough for some of them and too high for the others.
TEST(slack_path, fills_as_many_equal_gaps_as_it_may) {
  std::vector<slack_column> columns;
  for (int i = 0; i < 50; ++i) {
    columns.push_back(gap(2));
    columns.push_back(seen(3));
  }
  std::vector<bool> drawn;
  for (const std::uint64_t budget : {1u, 2u, 7u, 60u, 97u}) {
    EXPECT_EQ(chosen(columns, true, budget, flat, drawn), budget / 2 * 2);
  }
}

TEST(slack_path, does_not_fill_what_saves_too_little) {
  const std::vector<slack_column> columns{seen(1), gap(41), seen(1), gap(39), seen(1)};
  std::vector<bool> drawn;
  EXPECT_EQ(chosen(columns, true, plenty, flat, drawn), 39u);  // 10 bits for at most 40 polygons
}

TEST(slack_path, keeps_what_the_reference_draws) {
  std::vector<slack_column> columns{seen(4), gap(2), seen(3), gap(6)};
  for (slack_column& c : columns) c.in_reference = true;
  std::vector<bool> drawn;
  EXPECT_EQ(chosen(columns, false, plenty, flat, drawn), 8u);  // no difference is left
  EXPECT_EQ(chosen(columns, false, 2, flat, drawn), 2u);
  EXPECT_TRUE(drawn[1]);
}

// Ranks count members of the reference: numbers between two runs to remove that are not in it do not separate them.
TEST(slack_path, counts_runs_in_rank_space) {
  std::vector<slack_column> columns{seen(4), gap(2), gap(9), gap(2), seen(4)};
  for (const std::size_t i : {0u, 1u, 3u, 4u}) columns[i].in_reference = true;
  std::vector<bool> drawn;
  EXPECT_EQ(chosen(columns, false, 2, flat, drawn), 0u);  // half of one run saves nothing
  EXPECT_EQ(chosen(columns, false, 4, flat, drawn), 4u);
  EXPECT_FALSE(drawn[2]);
}

TEST(slack_path, gains_what_several_heirs_have) {
  std::vector<slack_column> columns{seen(4), gap(50), gap(1), gap(50), seen(4)};
  std::vector<bool> drawn;
  columns.front().heirs = columns.back().heirs = 7;
  columns[2].heirs = 1;
  EXPECT_EQ(chosen(columns, true, plenty, flat, drawn), 0u);
  columns[2].heirs = 7;
  EXPECT_EQ(chosen(columns, true, plenty, flat, drawn), 1u);
  EXPECT_TRUE(drawn[2]);
}

TEST(slack_path, ranges_end_where_draws_begin) {
  constexpr slack_prices ranges_only{0, 0, 0, 10 * slack_price_unit};
  std::vector<slack_column> columns{seen(4), gap(2), seen(4)};
  std::vector<bool> drawn;
  EXPECT_EQ(chosen(columns, true, plenty, ranges_only, drawn), 2u);
  columns[1].borders = 1;
  EXPECT_EQ(chosen(columns, true, plenty, ranges_only, drawn), 0u);
  columns[1].borders = 0;
  columns[1].begins_draw = true;
  EXPECT_EQ(chosen(columns, true, plenty, ranges_only, drawn), 0u);
  columns[1].begins_draw = false;
  columns[2].begins_draw = true;
  EXPECT_EQ(chosen(columns, true, plenty, ranges_only, drawn), 0u);
}

// The cost of a choice, counted list by list, at the lowest price of a polygon.
std::uint64_t cost_of(const std::vector<slack_column>& columns, bool alone, const slack_prices& prices,
                      const std::vector<bool>& drawn) {
  std::uint64_t cost = 0;
  bool adding = false, removing = false, drawing = false;
  std::vector<bool> heir_adds(3), heir_removes(3);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const slack_column& c = columns[i];
    if (drawn[i] && !c.seen) cost += c.size * slack_price_unit / 4;
    if (drawn[i]) cost += (c.borders + (drawing && !c.begins_draw ? 0u : 1u)) * std::uint64_t{prices.range};
    drawing = drawn[i];
    if (c.in_reference) {
      if (!drawn[i] && !removing) cost += prices.removed;
      removing = !drawn[i];
    } else {
      if (drawn[i] && !adding) cost += alone ? prices.own : prices.added;
      adding = drawn[i];
    }
    for (std::size_t heir = 0; heir < 3; ++heir) {
      const bool sees = (c.heirs >> heir & 1u) != 0;
      if (sees && !drawn[i] && !heir_adds[heir]) cost += prices.added;
      if (!sees && drawn[i] && !heir_removes[heir]) cost += prices.removed / 2;
      heir_adds[heir] = sees && !drawn[i];
      heir_removes[heir] = !sees && drawn[i];
    }
  }
  return cost;
}

TEST(slack_path, is_as_cheap_as_any_choice) {
  random_source random(1);
  for (int round = 0; round < 300; ++round) {
    const bool alone = round % 2 == 0;
    std::vector<slack_column> columns(9);
    for (slack_column& c : columns) {
      c = {.heirs = random() % 8,
           .size = 1 + random() % 20,
           .borders = random() % 5 == 0 ? 1u : 0u,
           .begins_draw = random() % 5 == 0,
           .seen = random() % 2 == 0,
           .in_reference = !alone && random() % 2 == 0};
    }
    columns[0].heirs = 7;
    const slack_prices prices{2000 + 2 * (random() % 1000), 1800, 2600, random() % 3000};
    std::vector<bool> drawn;
    chosen(columns, alone, plenty, prices, drawn);
    std::uint64_t best = std::numeric_limits<std::uint64_t>::max();
    for (unsigned choice = 0; choice < 512; ++choice) {
      std::vector<bool> other(9);
      bool keeps = true;
      for (std::size_t i = 0; i < 9; ++i) {
        other[i] = (choice >> i & 1u) != 0;
        keeps = keeps && (other[i] || !columns[i].seen);
      }
      if (keeps) best = std::min(best, cost_of(columns, alone, prices, other));
    }
    ASSERT_EQ(cost_of(columns, alone, prices, drawn), best) << round;
  }
}

// ---- A chunk.

struct widened_chunk {
  set_list exact, sets;
  slack_sums sums;
  std::uint64_t bits_before = 0, bits_after = 0;
};

std::uint64_t bits_of(const set_list& sets, const row_encoders& encoders) {
  row_counts counts;
  count_chunk(sets, plan_chunk(sets, encoders, limit), counts);
  std::vector<std::byte> bytes;
  encode_chunk(sets, plan_chunk(sets, encoders, limit), row_encoders(counts), bytes);
  return 8 * bytes.size();
}

widened_chunk widen(std::uint32_t seed, std::size_t count, std::uint64_t share) {
  widened_chunk w;
  w.exact = w.sets = like_sets(seed, count);
  row_counts counts;
  for (const auto& set : w.sets) counts.own.add(set);
  counts.removed = counts.added = counts.own;
  const row_encoders encoders(counts);
  const chunk_plan plan = plan_chunk(w.sets, encoders, limit, {.least = least_saving::anything});
  w.bits_before = bits_of(w.sets, encoders);
  add_slack(w.sets, plan, some_borders(), slack_prices_of(counts, encoders), share, w.sums);
  w.bits_after = bits_of(w.sets, encoders);
  return w;
}

TEST(slack, sets_of_a_chunk_only_grow_and_keep_their_budget) {
  for (const std::size_t count : {1u, 2u, 9u, 64u}) {
    for (const std::uint64_t share : {1000u, 50000u, 100000u, 1000000u}) {
      const widened_chunk w = widen(static_cast<std::uint32_t>(count), count, share);
      expect_supersets(w.sets, w.exact, share);
      std::uint64_t before = 0, after = 0;
      for (const auto& set : w.exact) before += polygons_of(set);
      for (const auto& set : w.sets) after += polygons_of(set);
      EXPECT_EQ(w.sums.seen, before);
      EXPECT_EQ(w.sums.added, after - before);
      EXPECT_LE(w.sums.added, before * share / slack_share_unit);
    }
  }
}

TEST(slack, makes_runs_ranges_and_bits_fewer) {
  const widened_chunk w = widen(3, 64, 100000);
  EXPECT_GT(w.sums.added, w.sums.seen * 8 / 100) << "most of the budget is used";
  EXPECT_LT(runs_of_all(w.sets), runs_of_all(w.exact) * 8 / 10);
  EXPECT_LT(ranges_of(w.sets), ranges_of(w.exact) * 8 / 10);
  EXPECT_LT(w.bits_after, w.bits_before * 9 / 10);
}

TEST(slack, more_of_it_saves_more) {
  const widened_chunk balanced = widen(4, 64, 50000);
  const widened_chunk small = widen(4, 64, 100000);
  EXPECT_LT(small.bits_after, balanced.bits_after);
  EXPECT_LT(ranges_of(small.sets), ranges_of(balanced.sets));
}

TEST(slack, equal_sets_stay_equal_and_empty_and_full_ones_as_they_are) {
  const widened_chunk w = widen(5, 64, 100000);
  for (const std::size_t cell : {8u, 17u}) {
    ASSERT_EQ(borders_of(w.exact[cell]), borders_of(w.exact[4]));
    EXPECT_EQ(borders_of(w.sets[cell]), borders_of(w.sets[4]));
  }
  EXPECT_GT(polygons_of(w.sets[4]), polygons_of(w.exact[4]));
  EXPECT_TRUE(w.sets[5].empty());
  EXPECT_EQ(borders_of(w.sets[6]), (std::vector<std::uint32_t>{0, limit}));
}

// Far from all that the reference has, one polygon that all its heirs have.
TEST(slack, references_gain_what_their_heirs_have) {
  chunk_plan plan;
  set_list sets;
  for (std::uint8_t cell = 0; cell < 6; ++cell) {
    sets.push_back({{100, 100}});
    if (cell > 0) sets.back().push_back({500, 1});
    sets.back().push_back({1000 + 50u * cell, 40});
    plan.same.push_back(cell);
    plan.reference.push_back(cell == 0 ? chunk_plan::alone : 0);
  }
  slack_sums sums;
  add_slack(sets, plan, some_borders(), flat, 10000, sums);  // one polygon for each cell
  EXPECT_EQ(borders_of(sets[0]), (std::vector<std::uint32_t>{100, 200, 500, 501, 1000, 1040}));
  EXPECT_EQ(sums.added, 1u);
}

// The heir gains nothing from filling the gap before its reference does; then this saves a run to remove.
TEST(slack, heirs_know_what_their_reference_gained) {
  const chunk_plan plan{{0, 1}, {1, chunk_plan::alone}};
  set_list sets{{{100, 20}, {121, 20}, {900, 30}}, {{100, 20}, {121, 20}}};
  slack_sums sums;
  add_slack(sets, plan, some_borders(), flat, 50000, sums);
  EXPECT_EQ(borders_of(sets[1]), (std::vector<std::uint32_t>{100, 141}));
  EXPECT_EQ(borders_of(sets[0]), (std::vector<std::uint32_t>{100, 141, 900, 930}));
}

// A difference that saves little without slack may save much with it. The more runs two sets have in common, the more
// it saves: first nothing, then too little, then enough.
TEST(slack, is_planned_with_any_difference_that_saves) {
  std::vector<std::uint32_t> first_saving;
  for (const least_saving least : {least_saving::anything, least_saving::an_eighth}) {
    for (std::uint32_t common = 0; common <= 80; ++common) {
      set_list sets(2);
      random_source random(1);
      for (std::uint32_t i = 0; i < 80; ++i) {
        for (auto& set : sets) set.push_back({30 * i + random() % 15, 1 + random() % 14});
        if (i < common) sets[1].back() = sets[0].back();
      }
      row_counts counts;
      for (const auto& set : sets) counts.own.add(set);
      counts.removed = counts.added = counts.own;
      const chunk_plan plan = plan_chunk(sets, row_encoders(counts), limit, {.least = least});
      if (plan.reference == std::vector<std::uint8_t>(2, chunk_plan::alone)) continue;
      first_saving.push_back(common);
      break;
    }
  }
  ASSERT_EQ(first_saving.size(), 2u);
  EXPECT_GT(first_saving[0], 0u);
  EXPECT_LT(first_saving[0], first_saving[1]);
}

// Filling a gap where a draw begins makes no range fewer. The other cell cuts each gap in two.
TEST(slack, knows_where_draws_begin) {
  constexpr slack_prices ranges_only{0, 0, 0, 10 * slack_price_unit};
  std::vector<draw_record> draws;
  for (std::uint32_t d = 0; d < 10; ++d) draws.push_back({.polygon_count = 100, .first_stored = 100 * d});
  draws.insert(draws.begin() + 6, draw_record{.polygon_count = 0, .first_stored = 600});
  // Gaps: inside a draw; around a border; up to one; from one; inside a draw, after an empty one.
  set_list sets{{{10, 30}, {44, 50}, {104, 94}, {202, 94}, {300, 98}, {400, 10}, {500, 100}, {604, 10}, {618, 2}},
                {{42, 54}, {100, 99}, {298, 104}, {600, 16}}};
  const chunk_plan plan{{0, 1}, {chunk_plan::alone, chunk_plan::alone}};
  slack_sums sums;
  add_slack(sets, plan, range_borders(draws, host_layout::instanced), ranges_only, slack_share_unit, sums);
  const std::vector<std::uint32_t> expected{10, 94, 104, 198, 202, 296, 300, 398, 400, 410, 500, 600, 604, 620};
  EXPECT_EQ(borders_of(sets[0]), expected);
}

TEST(slack, prices_are_bits_per_run) {
  row_counts counts;
  // Gaps 1 and lengths 1, each a code of one bit; in removed runs, gaps of 100 have five raw bits more.
  counts.own.gap[1] = counts.own.more[0] = 7;
  counts.removed.gap[symbol_of(100).symbol] = counts.removed.more[0] = 3;
  const slack_prices prices = slack_prices_of(counts, row_encoders(counts));
  EXPECT_EQ(prices.own, 2 * slack_price_unit);
  EXPECT_EQ(prices.removed, 7 * slack_price_unit);
  EXPECT_EQ(prices.added, 0u);
  EXPECT_GT(prices.range, 0u);
}

// ---- A file.

class slack_file : public testing::Test {
 protected:
  slack_file() {
    // Stored in reverse, draw by draw, so that stored numbers differ from source ids.
    for (std::size_t d = 0; d < draws_.size(); ++d) {
      order_of_draw_.push_back(static_cast<std::uint32_t>(d));
      orders_.emplace_back(draws_[d].polygon_count);
      for (std::uint32_t i = 0; i < draws_[d].polygon_count; ++i) orders_[d][i] = draws_[d].polygon_count - 1 - i;
    }
    for (std::uint32_t cell = 0; cell < exact_.size(); ++cell) {
      const auto x = static_cast<float>(cell);
      cells_.push_back({{x, 0, 0}, {x + 1, 1, 1}});
      const std::vector<bool> members = members_of(exact_[cell]);
      for (const draw_record& d : draws_) {
        for (std::uint32_t i = 0; i < d.polygon_count; ++i) {
          if (members[d.first_stored + d.polygon_count - 1 - i]) ids_[cell].push_back(d.first_source + i);
        }
      }
    }
  }

  file_contents contents(double slack) {
    file_contents all;
    all.facts.polygon_count = limit;
    all.draws = draws_;
    all.order = {order_of_draw_, orders_};
    all.cells = cells_;
    all.cell_sets = sets_of(ids_);
    all.slack = slack;
    return all;
  }

  static std::vector<std::byte> encoded(const file_contents& all) {
    std::vector<std::byte> bytes;
    EXPECT_EQ(encode(all, bytes), status::ok);
    return bytes;
  }

  // The sets of a file in stored order, after a check of the whole file.
  static set_list sets_in(const std::vector<std::byte>& bytes, float& slack) {
    reader file;
    EXPECT_EQ(reader::open(bytes, file), status::ok);
    slack = file.facts().slack;
    set_reader sets;
    EXPECT_EQ(sets.open(file), status::ok);
    EXPECT_EQ(sets.check(), status::ok);
    set_list all;
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
      std::span<const run> runs;
      EXPECT_EQ(sets.runs(cell, runs), status::ok);
      all.emplace_back(runs.begin(), runs.end());
    }
    return all;
  }

  static const set_list& exact_sets() {
    static const set_list sets = like_sets(6, 400);  // of which a sample is planned first
    return sets;
  }

  // Leaves out most cells: for what does not depend on a sample being planned first.
  void keep_cells(std::size_t count) { exact_.resize(count), cells_.resize(count), ids_.resize(count); }

  set_list exact_ = exact_sets();
  std::vector<draw_record> draws_ = some_draws();
  std::vector<std::uint32_t> order_of_draw_;
  std::vector<std::vector<std::uint32_t>> orders_;
  std::vector<box> cells_;
  std::vector<std::vector<std::uint32_t>> ids_{exact_.size()};
};

TEST_F(slack_file, without_slack_sets_are_exact) {
  keep_cells(120);
  float slack = 1.0f;
  const set_list sets = sets_in(encoded(contents(0.0)), slack);
  EXPECT_EQ(slack, 0.0f);
  for (std::size_t cell = 0; cell < exact_.size(); ++cell) {
    ASSERT_EQ(borders_of(sets[cell]), borders_of(exact_[cell])) << cell;
  }
}

TEST_F(slack_file, every_cell_keeps_its_polygons_and_its_budget) {
  const std::size_t exact_size = encoded(contents(0.0)).size();
  std::size_t last_size = exact_size;
  for (const double share : {0.05, 0.1}) {
    const auto bytes = encoded(contents(share));
    float slack = 0.0f;
    const set_list sets = sets_in(bytes, slack);
    expect_supersets(sets, exact_, static_cast<std::uint64_t>(share * 1e6 + 0.5));
    EXPECT_LT(bytes.size(), last_size);
    EXPECT_LT(ranges_of(sets), ranges_of(exact_) * 9 / 10);
    EXPECT_LT(runs_of_all(sets), runs_of_all(exact_) * 9 / 10);
    last_size = bytes.size();
  }
  EXPECT_LT(last_size, exact_size * 9 / 10);
}

TEST_F(slack_file, header_has_the_added_share) {
  keep_cells(120);
  float slack = 0.0f;
  const set_list sets = sets_in(encoded(contents(0.05)), slack);
  std::uint64_t before = 0, after = 0;
  for (const auto& set : exact_) before += polygons_of(set);
  for (const auto& set : sets) after += polygons_of(set);
  const double actual = static_cast<double>(after - before) / static_cast<double>(before);
  EXPECT_GT(actual, 0.03);
  EXPECT_GE(static_cast<double>(slack), actual);
  EXPECT_LT(static_cast<double>(std::nextafter(slack, 0.0f)), actual);

  file_contents again = contents(0.05);
  again.facts.slack = 0.1f;
  float both = 0.0f;
  sets_in(encoded(again), both);
  const double together = (1.0 + static_cast<double>(0.1f)) * (1.0 + actual) - 1.0;
  EXPECT_GE(static_cast<double>(both), together);
  EXPECT_NEAR(static_cast<double>(both), together, 1e-7);
  again.slack = 0.0;
  sets_in(encoded(again), both);
  EXPECT_EQ(both, 0.1f) << "nothing was added";
}

// A single draw group has no borders between draws: the same polygons are added for fewer ranges.
TEST_F(slack_file, of_a_draw_group_knows_no_draws) {
  keep_cells(120);
  const auto ranges_at = [&](const std::vector<std::byte>& bytes) {
    reader file;
    EXPECT_EQ(reader::open(bytes, file), status::ok);
    set_reader sets;
    row_statistics sums;
    EXPECT_EQ(sets.open(file), status::ok);
    EXPECT_EQ(sets.check(), status::ok);
    EXPECT_EQ(sets.statistics(sums), status::ok);
    return sums.ranges;
  };
  const std::uint64_t of_draws = ranges_at(encoded(contents(0.05)));
  file_contents merged = contents(0.05);
  merged.facts.layout = host_layout::merged;
  order_of_draw_.assign(draws_.size(), 0);
  orders_ = {{}};
  for (const draw_record& d : draws_) {
    for (std::uint32_t i = d.polygon_count; i-- > 0;) orders_[0].push_back(d.first_stored + i);
  }
  merged.order = {order_of_draw_, orders_};
  const auto bytes = encoded(merged);
  float slack = 0.0f;
  expect_supersets(sets_in(bytes, slack), exact_, 50000);
  EXPECT_LT(ranges_at(bytes), of_draws);
}

TEST_F(slack_file, same_contents_same_bytes) {
  EXPECT_EQ(encoded(contents(0.05)), encoded(contents(0.05)));
}

TEST_F(slack_file, shares_that_are_none) {
  keep_cells(20);
  std::vector<std::byte> bytes;
  for (const double share : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(encode(contents(share), bytes), status::argument) << share;
    file_contents before = contents(0.0);
    before.facts.slack = static_cast<float>(share);
    EXPECT_EQ(encode(before, bytes), status::argument) << share;
  }
  file_contents full = contents(0.05);
  full.facts.slack = 1.0f;
  EXPECT_EQ(encode(full, bytes), status::limit) << "more than the header can hold";
  EXPECT_TRUE(bytes.empty());
}

TEST_F(slack_file, nothing_to_add_to) {
  for (auto& set : ids_) set.clear();
  float slack = 1.0f;
  for (const auto& set : sets_in(encoded(contents(0.1)), slack)) EXPECT_TRUE(set.empty());
  EXPECT_EQ(slack, 0.0f);
  ids_.clear();
  cells_.clear();
  EXPECT_TRUE(sets_in(encoded(contents(0.1)), slack).empty());
}

}  // namespace
