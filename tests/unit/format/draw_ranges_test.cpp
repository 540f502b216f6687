#include "sightcell/format/draw_ranges.h"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "random_source.h"

namespace {

using sightcell::format::for_each_draw_range;
using sightcell::format::run;
using range = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

std::vector<range> ranges_of(const std::vector<run>& runs, const std::vector<std::uint32_t>& firsts,
                             std::uint32_t polygons) {
  std::vector<range> ranges;
  for_each_draw_range(
      runs, static_cast<std::uint32_t>(firsts.size()), polygons, [&](std::uint32_t d) { return firsts.at(d); },
      [&](std::uint32_t d, std::uint32_t first, std::uint32_t count) { ranges.emplace_back(d, first, count); });
  return ranges;
}

TEST(draw_ranges, runs_are_cut_at_draw_borders) {
  const std::vector<range> expected{{0, 3, 2}, {2, 0, 5}, {3, 0, 1}};
  EXPECT_EQ(ranges_of({{3, 8}}, {0, 5, 5, 10}, 20), expected);
}

TEST(draw_ranges, against_one_polygon_at_a_time) {
  sightcell::test::random_source random(8);
  for (std::uint32_t round = 0; round < 2000; ++round) {
    std::vector<std::uint32_t> firsts{0};
    while (firsts.size() < 1 + round % 40) firsts.push_back(firsts.back() + (random() % 3 == 0 ? 0 : random() % 9));
    const std::uint32_t polygons = firsts.back() + random() % 9;
    std::vector<run> runs;
    std::vector<range> expected;
    bool open = false;
    for (std::uint32_t p = 0; p < polygons; ++p) {
      if (random() % 3 == 0) {
        open = false;
        continue;
      }
      if (!open) runs.push_back({p, 0});
      ++runs.back().count;
      std::uint32_t draw = static_cast<std::uint32_t>(firsts.size()) - 1;
      while (firsts[draw] > p) --draw;
      if (open && std::get<0>(expected.back()) == draw) {
        ++std::get<2>(expected.back());
      } else {
        expected.emplace_back(draw, p - firsts[draw], 1);
      }
      open = true;
    }
    ASSERT_EQ(ranges_of(runs, firsts, polygons), expected);
  }
}

// The reader calls it with a file that may change at any time.
TEST(draw_ranges, nonsense_borders_end_and_stay_inside) {
  sightcell::test::random_source random(9);
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::uint32_t> firsts(random() % 20);
    for (auto& f : firsts) f = random() % 4 == 0 ? random() : random() % 100;
    for (const auto& [draw, first, count] : ranges_of({{0, 3}, {10, 60}, {90, 10}}, firsts, 100)) {
      ASSERT_LT(draw, firsts.size());
      ASSERT_LE(count, 60u);
      static_cast<void>(first);
    }
  }
}

TEST(draw_ranges, no_draws_no_ranges) {
  EXPECT_TRUE(ranges_of({{0, 1}}, {}, 1).empty());
}

}  // namespace
