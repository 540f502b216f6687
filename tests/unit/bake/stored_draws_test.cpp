#include "stored_draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <tuple>

namespace sightcell::bake {
namespace {

using numbers = std::vector<std::uint32_t>;

// Two meshes with three instances each, mixed, a primitive of another count, and a draw without polygons.
std::vector<format::draw_record> some_draws() {
  std::vector<format::draw_record> draws;
  std::uint32_t next = 0;
  const auto add = [&](std::uint32_t mesh, std::uint32_t primitive, std::uint32_t count) {
    format::draw_record d{.node = static_cast<std::uint32_t>(draws.size()), .mesh = mesh, .primitive = primitive};
    d.first_source = d.first_stored = next;
    d.polygon_count = count;
    draws.push_back(d);
    next += count;
  };
  for (int i = 0; i < 3; ++i) add(0, 0, 20), add(1, 0, 30), add(0, 1, 5);
  add(2, 0, 0);
  add(1, 0, 29);  // the same primitive with one polygon less: no instance of it
  return draws;
}

std::vector<numbers> some_sets(std::uint32_t polygons, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<numbers> sets(40);
  for (numbers& set : sets) {
    const auto modulus = static_cast<std::uint32_t>(2 + random() % 9);
    for (std::uint32_t p = 0; p < polygons; ++p)
      if ((p * 17 + 3) % 31 % modulus == 0) set.push_back(p);
  }
  return sets;
}

stored_draws stored(const std::vector<format::draw_record>& draws, const std::vector<numbers>& sets,
                    polygon_order_kind kind = polygon_order_kind::per_mesh) {
  return store_draws(draws, kind, static_cast<std::uint32_t>(sets.size()), [&](std::uint32_t cell, numbers& set) {
    EXPECT_TRUE(set.empty());
    set = sets[cell];
  });
}

TEST(stored_draws, every_draw_once_and_one_order_for_instances) {
  const auto draws = some_draws();
  const stored_draws out = stored(draws, some_sets(194, 1));
  ASSERT_EQ(out.draws.size(), draws.size());
  ASSERT_EQ(out.order_of_draw.size(), draws.size());
  EXPECT_EQ(out.orders.size(), 5u);
  std::uint32_t next = 0;
  std::vector<bool> seen(draws.size());
  for (std::size_t i = 0; i < out.draws.size(); ++i) {
    const format::draw_record& d = out.draws[i];
    EXPECT_EQ(d.first_stored, next);
    next += d.polygon_count;
    const format::draw_record& was = draws.at(d.node);
    EXPECT_FALSE(seen[d.node]);
    seen[d.node] = true;
    EXPECT_EQ(std::tie(d.mesh, d.primitive, d.first_source, d.polygon_count),
              std::tie(was.mesh, was.primitive, was.first_source, was.polygon_count));
    numbers order = out.orders.at(out.order_of_draw[i]);
    EXPECT_EQ(order.size(), d.polygon_count);
    std::sort(order.begin(), order.end());
    for (std::uint32_t k = 0; k < order.size(); ++k) EXPECT_EQ(order[k], k);
    for (std::size_t k = 0; k < i; ++k) {
      const bool same = out.draws[k].mesh == d.mesh && out.draws[k].primitive == d.primitive &&
                        out.draws[k].polygon_count == d.polygon_count;
      EXPECT_EQ(same, out.order_of_draw[k] == out.order_of_draw[i]);
    }
  }
  EXPECT_EQ(next, 194u);
}

// What polygons are seen together lies together: fewer runs than in the order of the source.
TEST(stored_draws, sets_are_fewer_runs) {
  const auto draws = some_draws();
  const auto sets = some_sets(194, 2);
  const stored_draws out = stored(draws, sets);
  numbers stored_of(194);
  for (std::size_t i = 0; i < out.draws.size(); ++i)
    for (std::uint32_t k = 0; k < out.draws[i].polygon_count; ++k)
      stored_of[out.draws[i].first_source + out.orders[out.order_of_draw[i]][k]] = out.draws[i].first_stored + k;
  const auto runs = [](numbers set) {
    std::sort(set.begin(), set.end());
    std::size_t count = 0;
    for (std::size_t i = 0; i < set.size(); ++i) count += i == 0 || set[i - 1] + 1 != set[i] ? 1 : 0;
    return count;
  };
  std::size_t before = 0, after = 0;
  for (const numbers& set : sets) {
    before += runs(set);
    numbers there;
    for (const std::uint32_t p : set) there.push_back(stored_of[p]);
    after += runs(there);
  }
  EXPECT_LT(2 * after, before);
}

// A file's table has another order than the scene's; what comes out is the same.
TEST(stored_draws, the_order_in_which_draws_come_does_not_matter) {
  auto draws = some_draws();
  const auto sets = some_sets(194, 3);
  const stored_draws once = stored(draws, sets);
  const stored_draws again = stored(once.draws, sets);
  EXPECT_EQ(once.orders, again.orders);
  EXPECT_EQ(once.order_of_draw, again.order_of_draw);
  for (std::size_t i = 0; i < draws.size(); ++i) EXPECT_EQ(once.draws[i].node, again.draws[i].node);
}

TEST(stored_draws, an_order_for_each_instance) {
  const stored_draws out = stored(some_draws(), some_sets(194, 4), polygon_order_kind::per_instance);
  EXPECT_EQ(out.orders.size(), 11u);
  std::vector<bool> used(11);
  for (const std::uint32_t order : out.order_of_draw) {
    EXPECT_FALSE(used.at(order));
    used[order] = true;
  }
}

TEST(stored_draws, no_draws_and_no_cells) {
  EXPECT_TRUE(stored({}, {}).draws.empty());
  const stored_draws out = stored(some_draws(), {});
  EXPECT_EQ(out.draws.size(), 11u);
}

}  // namespace
}  // namespace sightcell::bake
