#include "stored_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "random_source.h"

namespace {

using namespace sightcell::format;
using sightcell::test::random_source;

// Draws that are stored in another order than that of the source; three share an order, one is empty.
struct scene {
  std::vector<draw_record> draws;
  std::vector<std::uint32_t> order_of_draw{1, 0, 2, 0, 3, 0};
  std::vector<std::vector<std::uint32_t>> orders;
  std::uint32_t polygons = 0;
};

scene make_scene(random_source& random, std::vector<std::uint32_t> sizes) {
  scene s;
  for (const std::uint32_t size : sizes) {
    std::vector<std::uint32_t> order(size);
    std::iota(order.begin(), order.end(), 0u);
    shuffle(random, order);
    s.orders.push_back(order);
  }
  for (const std::uint32_t order : s.order_of_draw) {
    draw_record d;
    d.polygon_count = sizes[order];
    d.first_stored = s.polygons;
    s.polygons += d.polygon_count;
    s.draws.push_back(d);
  }
  std::uint32_t next = 0;
  for (const std::size_t d : {3u, 0u, 5u, 4u, 2u, 1u}) {
    s.draws[d].first_source = next;
    next += s.draws[d].polygon_count;
  }
  return s;
}

std::vector<std::uint32_t> source_of_stored(const scene& s) {
  std::vector<std::uint32_t> source;
  for (std::size_t d = 0; d < s.draws.size(); ++d) {
    for (const std::uint32_t local : s.orders[s.order_of_draw[d]]) source.push_back(s.draws[d].first_source + local);
  }
  return source;
}

// Sets whose members are likely to be neighbors in stored order; an empty one and a full one.
std::vector<std::vector<std::uint32_t>> random_sets(random_source& random, const scene& s, int count) {
  std::vector<std::vector<std::uint32_t>> sets;
  for (int i = 0; i < count; ++i) {
    std::vector<std::uint32_t> set;
    bool in = random() % 2 == 0;
    for (const std::uint32_t id : source_of_stored(s)) {
      if (random() % 40 == 0) in = !in;
      if (in) set.push_back(id);
    }
    std::sort(set.begin(), set.end());
    sets.push_back(set);
  }
  sets.emplace_back();
  sets.emplace_back(s.polygons);
  std::iota(sets.back().begin(), sets.back().end(), 0u);
  return sets;
}

TEST(stored_sets, sets_become_runs_of_stored_polygons) {
  random_source random(1);
  for (const auto& sizes :
       {std::vector<std::uint32_t>{40, 64, 0, 23}, {1, 1, 1, 1}, {128, 64, 0, 64}, {300, 5, 7, 2}}) {
    const scene s = make_scene(random, sizes);
    const auto source = source_of_stored(s);
    const stored_sets stored(s.draws, s.order_of_draw, s.orders);
    std::vector<std::uint64_t> bits;  // the same for all sets
    for (const auto& set : random_sets(random, s, 12)) {
      std::vector<run> runs{{7, 7}};
      stored.runs_of(set, bits, runs);
      std::vector<std::uint32_t> members;
      std::int64_t last = -1;
      for (const run& r : runs) {
        ASSERT_GT(r.count, 0u);
        ASSERT_GT(r.first, last);  // neither overlaps nor touches
        last = std::int64_t{r.first} + r.count;
        members.insert(members.end(), source.begin() + r.first, source.begin() + r.first + r.count);
      }
      std::sort(members.begin(), members.end());
      ASSERT_EQ(members, set);
    }
  }
}

// One draw group: its draws in source order, its polygons in any order.
TEST(stored_sets, draws_of_a_group_are_permuted_together) {
  const std::vector<draw_record> draws{{.group = 0, .first_source = 3, .polygon_count = 2},
                                       {.group = 0, .first_source = 5, .polygon_count = 0, .first_stored = 2},
                                       {.group = 0, .first_source = 7, .polygon_count = 3, .first_stored = 2},
                                       {.group = 1, .first_source = 0, .polygon_count = 3, .first_stored = 5},
                                       {.group = 1, .first_source = 5, .polygon_count = 2, .first_stored = 8}};
  const std::vector<std::uint32_t> order_of_draw{0, 0, 0, 1, 1};
  const std::vector<std::vector<std::uint32_t>> orders{{4, 0, 2, 1, 3}, {3, 4, 0, 2, 1}};
  // Stored: 9 3 7 4 8, then 5 6 0 2 1.
  const stored_sets stored(draws, order_of_draw, orders, host_layout::merged);
  const auto runs_of = [&](const std::vector<std::uint32_t>& set) {
    std::vector<run> runs;
    std::vector<std::uint64_t> bits;
    stored.runs_of(set, bits, runs);
    std::vector<std::uint32_t> numbers;
    for (const run& r : runs) numbers.insert(numbers.end(), {r.first, r.count});
    return numbers;
  };
  EXPECT_EQ(runs_of({0, 5, 6}), (std::vector<std::uint32_t>{5, 3}));
  EXPECT_EQ(runs_of({1, 3, 7, 9}), (std::vector<std::uint32_t>{0, 3, 9, 1}));
  EXPECT_EQ(runs_of({4, 5, 8}), (std::vector<std::uint32_t>{3, 3}));
}

// The numbers of volumes stay, after those of polygons in any order.
TEST(stored_sets, volumes_follow_the_polygons) {
  const std::vector<draw_record> draws{{.polygon_count = 4}};
  const std::vector<std::uint32_t> order_of_draw{0};
  const std::vector<std::vector<std::uint32_t>> orders{{3, 2, 1, 0}};
  const stored_sets stored(draws, order_of_draw, orders, host_layout::instanced, 125);
  std::vector<run> runs;
  std::vector<std::uint64_t> bits;
  stored.runs_of(std::vector<std::uint32_t>{0, 3, 4, 5, 63, 64, 128}, bits, runs);
  std::vector<std::uint32_t> numbers;
  for (const run& r : runs) numbers.insert(numbers.end(), {r.first, r.count});
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{0, 1, 3, 3, 63, 2, 128, 1}));
}

TEST(stored_sets, no_polygons_at_all) {
  const stored_sets stored({}, {}, {});
  std::vector<run> runs{{1, 1}};
  std::vector<std::uint64_t> bits;
  stored.runs_of({}, bits, runs);
  EXPECT_TRUE(runs.empty());
}

}  // namespace
