#include "stored_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "random_source.h"

namespace {

using namespace sightcell::format;
using sightcell::test::random_source;

// Draws that are laid end to end in another order than that of the source; three share an order, one is empty.
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
    std::shuffle(order.begin(), order.end(), random);
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

std::vector<std::uint32_t> source_of_stored(const scene& s, std::span<const polygon_order> orders) {
  std::vector<std::uint32_t> source;
  for (std::size_t d = 0; d < s.draws.size(); ++d) {
    for (const std::uint32_t local : orders[s.order_of_draw[d]].source_of_stored) {
      source.push_back(s.draws[d].first_source + local);
    }
  }
  return source;
}

// Sets whose members are likely to be neighbors in the stored order.
std::vector<std::vector<std::uint32_t>> random_sets(random_source& random, const scene& s, const stored_sets& stored,
                                                    int count) {
  const auto source = source_of_stored(s, stored.orders());
  std::vector<std::vector<std::uint32_t>> sets;
  for (int i = 0; i < count; ++i) {
    std::vector<std::uint32_t> set;
    bool in = random() % 2 == 0;
    for (const std::uint32_t id : source) {
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

std::vector<std::uint32_t> members_of(const std::vector<run>& runs, const std::vector<std::uint32_t>& source) {
  std::vector<std::uint32_t> members;
  for (const run& r : runs) {
    members.insert(members.end(), source.begin() + r.first, source.begin() + r.first + r.count);
  }
  std::sort(members.begin(), members.end());
  return members;
}

void expect_runs(const std::vector<run>& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    ASSERT_GT(runs[i].count, 0u);
    if (i == 0) continue;
    ASSERT_GT(runs[i].first, runs[i - 1].first + runs[i - 1].count) << i;
  }
}

TEST(stored_sets, sets_become_runs_of_polygons_and_of_atoms) {
  random_source random(1);
  for (const auto& sizes :
       {std::vector<std::uint32_t>{40, 64, 0, 23}, {1, 1, 1, 1}, {128, 64, 0, 64}, {300, 5, 7, 2}}) {
    const scene s = make_scene(random, sizes);
    stored_sets stored(s.draws, s.order_of_draw, s.orders);
    const auto sets = random_sets(random, s, stored, 12);
    std::vector<std::vector<run>> before;
    std::vector<run> runs;
    for (const auto& set : sets) {
      stored.polygon_runs(set, runs);
      expect_runs(runs);
      ASSERT_EQ(members_of(runs, source_of_stored(s, stored.orders())), set);
      stored.mark(runs);
      before.push_back(runs);
    }
    stored.find_atoms();
    const auto source = source_of_stored(s, stored.orders());
    for (std::size_t i = 0; i < sets.size(); ++i) {
      stored.polygon_runs(sets[i], runs);
      ASSERT_EQ(members_of(runs, source), sets[i]);
      // Sorting inside atoms changes no run.
      ASSERT_EQ(runs.size(), before[i].size());
      for (std::size_t k = 0; k < runs.size(); ++k) {
        ASSERT_EQ(runs[k].first, before[i][k].first);
        ASSERT_EQ(runs[k].count, before[i][k].count);
      }
      stored.to_atoms(runs);
      expect_runs(runs);
      ASSERT_TRUE(runs.empty() || runs.back().first + runs.back().count <= stored.atom_count());
      // Back from atoms to polygons by the orders that a file has.
      std::vector<std::uint32_t> begin_of_atom;
      for (std::size_t d = 0; d < s.draws.size(); ++d) {
        ASSERT_EQ(stored.first_atom(d), begin_of_atom.size());
        const auto& order = stored.orders()[s.order_of_draw[d]];
        for (std::uint32_t local = 0; local < order.begins_atom.size(); ++local) {
          if (order.begins_atom[local]) begin_of_atom.push_back(s.draws[d].first_stored + local);
        }
      }
      begin_of_atom.push_back(s.polygons);
      ASSERT_EQ(begin_of_atom.size(), stored.atom_count() + 1u);
      for (std::size_t k = 0; k < runs.size(); ++k) {
        ASSERT_EQ(begin_of_atom[runs[k].first], before[i][k].first);
        ASSERT_EQ(begin_of_atom[runs[k].first + runs[k].count], before[i][k].first + before[i][k].count);
      }
    }
  }
}

// Two polygons are of one atom exactly where no set tells them apart in any draw of their order.
TEST(stored_sets, atoms_are_as_large_as_can_be) {
  random_source random(2);
  const scene s = make_scene(random, {90, 64, 3, 23});
  stored_sets stored(s.draws, s.order_of_draw, s.orders);
  const auto sets = random_sets(random, s, stored, 6);
  std::vector<run> runs;
  std::vector<std::set<std::uint32_t>> borders(4);
  for (const auto& set : sets) {
    stored.polygon_runs(set, runs);
    stored.mark(runs);
    const std::set<std::uint32_t> members(set.begin(), set.end());
    for (std::size_t d = 0; d < s.draws.size(); ++d) {
      const auto& order = s.orders[s.order_of_draw[d]];
      for (std::uint32_t i = 1; i < order.size(); ++i) {
        const bool here = members.contains(s.draws[d].first_source + order[i]);
        const bool there = members.contains(s.draws[d].first_source + order[i - 1]);
        if (here != there) borders[s.order_of_draw[d]].insert(i);
      }
    }
  }
  stored.find_atoms();
  std::size_t larger = 0;
  for (std::size_t o = 0; o < borders.size(); ++o) {
    const auto& begins = stored.orders()[o].begins_atom;
    for (std::uint32_t i = 0; i < begins.size(); ++i) {
      EXPECT_EQ(begins[i], i == 0 || borders[o].contains(i));
      larger += begins[i] ? 0 : 1;
    }
  }
  EXPECT_GT(larger, 20u);
}

TEST(stored_sets, inside_atoms_polygons_ascend) {
  random_source random(3);
  const scene s = make_scene(random, {90, 64, 3, 23});
  stored_sets stored(s.draws, s.order_of_draw, s.orders);
  stored.find_atoms();  // nothing was marked: every draw is one atom
  EXPECT_EQ(stored.atom_count(), s.draws.size());
  for (const polygon_order& order : stored.orders()) {
    EXPECT_TRUE(std::is_sorted(order.source_of_stored.begin(), order.source_of_stored.end()));
  }
}

}  // namespace
