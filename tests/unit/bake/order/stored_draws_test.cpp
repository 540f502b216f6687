#include "order/stored_draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <tuple>

#include "sightcell/format/writer.h"

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
                    format::host_layout layout = format::host_layout::instanced,
                    polygon_order_kind kind = polygon_order_kind::per_mesh) {
  return store_draws(draws, layout, kind, static_cast<std::uint32_t>(sets.size()),
                     [&](std::uint32_t cell, numbers& set) {
                       EXPECT_TRUE(set.empty());
                       set = sets[cell];
                     });
}

// Where each polygon is stored.
numbers stored_of_source(const stored_draws& out, format::host_layout layout) {
  numbers stored_of(194);
  for (std::size_t begin = 0, end = 0; begin < out.draws.size(); begin = end) {
    numbers sources;
    do {
      for (std::uint32_t k = 0; k < out.draws[end].polygon_count; ++k)
        sources.push_back(out.draws[end].first_source + k);
      ++end;
    } while (layout == format::host_layout::merged && end < out.draws.size() &&
             out.draws[end].group == out.draws[begin].group);
    const numbers& order = out.orders[out.order_of_draw[begin]];
    EXPECT_EQ(order.size(), sources.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) stored_of[sources[order[k]]] = out.draws[begin].first_stored + k;
  }
  return stored_of;
}

// Of all sets together.
std::size_t runs_of(const std::vector<numbers>& sets, const numbers& stored_of) {
  std::size_t runs = 0;
  for (const numbers& set : sets) {
    numbers there;
    for (const std::uint32_t p : set) there.push_back(stored_of[p]);
    std::sort(there.begin(), there.end());
    for (std::size_t i = 0; i < there.size(); ++i) runs += i == 0 || there[i - 1] + 1 != there[i] ? 1 : 0;
  }
  return runs;
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
  constexpr auto layout = format::host_layout::instanced;
  numbers as_source(194);
  std::iota(as_source.begin(), as_source.end(), 0u);
  EXPECT_LT(2 * runs_of(sets, stored_of_source(stored(draws, sets), layout)), runs_of(sets, as_source));
}

// Three groups, one of them of a draw alone.
std::vector<format::draw_record> grouped_draws() {
  auto draws = some_draws();
  for (format::draw_record& d : draws) d.group = d.node == 4 ? 70 : 7 + d.node % 2;
  return draws;
}

TEST(stored_draws, draws_of_a_group_lie_together) {
  constexpr auto merged = format::host_layout::merged;
  const auto draws = grouped_draws();
  const auto sets = some_sets(194, 4);
  const stored_draws out = stored(draws, sets, merged);
  ASSERT_EQ(out.draws.size(), draws.size());
  EXPECT_EQ(out.orders.size(), 3u);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < out.draws.size(); ++i) {
    const format::draw_record& d = out.draws[i];
    EXPECT_EQ(d.first_stored, next);
    next += d.polygon_count;
    EXPECT_EQ(out.order_of_draw[i], d.group);
    const std::uint32_t before = i == 0 ? 0 : out.draws[i - 1].group;
    EXPECT_TRUE(d.group == before || d.group == before + 1);
    EXPECT_EQ(i > 0 && d.group == before, i > 0 && draws.at(d.node).group == draws.at(out.draws[i - 1].node).group);
    EXPECT_TRUE(i == 0 || d.group != before || d.first_source >= out.draws[i - 1].first_source);
  }
  numbers all = stored_of_source(out, merged);
  EXPECT_LE(runs_of(sets, all), runs_of(sets, stored_of_source(stored(draws, sets), format::host_layout::instanced)));
  std::sort(all.begin(), all.end());
  for (std::uint32_t i = 0; i < 194; ++i) EXPECT_EQ(all[i], i);
  const stored_draws again = stored(out.draws, sets, merged);
  EXPECT_EQ(again.orders, out.orders);
  EXPECT_EQ(again.order_of_draw, out.order_of_draw);
}

TEST(stored_draws, a_table_in_groups_is_a_valid_one) {
  const auto table = in_groups(grouped_draws());
  format::file_contents contents;
  contents.facts.polygon_count = 194;
  contents.facts.layout = format::host_layout::merged;
  contents.draws = table;
  contents.cell_sets = format::sets_of({});
  std::vector<std::byte> bytes;
  EXPECT_EQ(format::encode(contents, bytes), format::status::ok);
  EXPECT_EQ(table.front().group, 0u);
  EXPECT_EQ(table.back().group, 2u);
  EXPECT_EQ(table.back().node, 4u);
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
  const stored_draws out =
      stored(some_draws(), some_sets(194, 4), format::host_layout::instanced, polygon_order_kind::per_instance);
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
