#include "cells/cell_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <compare>
#include <functional>
#include <random>

namespace sightcell::bake {
namespace {

// A square of a quadtree.
struct square {
  int z = 0, x = 0, level = 0;
  auto operator<=>(const square&) const = default;
};

// The options of a block of 8 x 8 cells, from the smallest squares to the largest.
struct block_options {
  std::vector<square> squares;
  std::vector<cell_option> options;

  // polygons_seen: from a square. Each smallest one has an area of 1.
  explicit block_options(const std::function<double(const square&)>& polygons_seen, int highest = 3) {
    for (int level = 0; level <= highest; ++level)
      for (int z = 0; z < 1 << (highest - level); ++z)
        for (int x = 0; x < 1 << (highest - level); ++x) squares.push_back({z, x, level});
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const square& at = squares[i];
      const square around{at.z / 2, at.x / 2, at.level + 1};
      const auto parent = std::find(squares.begin(), squares.end(), around);
      options.push_back({parent == squares.end() ? i : static_cast<std::size_t>(parent - squares.begin()),
                         at.level == 0, static_cast<double>(1 << 2 * at.level) * polygons_seen(at)});
    }
  }

  std::vector<square> chosen(double growth) const {
    std::vector<square> found;
    for (const std::size_t i : choose_cell_sizes(options, growth)) found.push_back(squares[i]);
    return found;
  }
};

TEST(cell_sizes, cells_that_see_the_same_become_one) {
  const auto chosen = block_options([](const square&) { return 100.0; }).chosen(0.0);
  EXPECT_EQ(chosen, (std::vector<square>{{0, 0, 3}}));
}

TEST(cell_sizes, cells_that_see_different_things_stay) {
  // Twice as many from each larger square; a little more further back.
  const block_options twice([](const square& at) {
    return 100.0 * (1 << at.level) + (at.level > 0 ? 0.1 * static_cast<double>(at.z * 8 + at.x) : 0.0);
  });
  EXPECT_EQ(twice.chosen(0.0701).size(), 61u) << "one square of four costs 4 / 64 x 100 % more";
  EXPECT_EQ(twice.chosen(0.01).size(), 64u);
  EXPECT_EQ(twice.chosen(7.0).size(), 1u);
}

// A wall between x = 3 and x = 4: squares across it see what is on both sides.
TEST(cell_sizes, nothing_merges_across_a_wall) {
  const auto chosen = block_options([](const square& at) { return at.level == 3 ? 200.0 : 100.0; }).chosen(0.1);
  ASSERT_EQ(chosen.size(), 4u);
  for (const square& at : chosen) EXPECT_EQ(at.level, 2);
}

TEST(cell_sizes, what_is_not_a_cell_is_not_chosen) {
  const block_options holes([](const square& at) { return at.level == 1 ? cell_option::not_a_cell : 100.0; }, 2);
  EXPECT_EQ(holes.chosen(0.0), (std::vector<square>{{0, 0, 2}}));
  const block_options none([](const square& at) { return at.level > 0 ? cell_option::not_a_cell : 100.0; }, 2);
  EXPECT_EQ(none.chosen(99.0).size(), 16u);
  EXPECT_TRUE(choose_cell_sizes({}, 0.1).empty());
}

// All ways to cut a square, as cells and what is drawn.
struct cut {
  std::size_t cells = 0;
  double drawn = 0.0;
};

std::vector<cut> all_cuts(const block_options& block, std::size_t root) {
  std::vector<cut> cuts{{1, block.options[root].drawn}};
  if (block.options[root].smallest) return cuts;
  std::vector<cut> inside{{0, 0.0}};
  for (std::size_t i = 0; i < root; ++i) {
    if (block.options[i].parent != root) continue;
    std::vector<cut> longer;
    for (const cut& a : inside)
      for (const cut& b : all_cuts(block, i)) longer.push_back({a.cells + b.cells, a.drawn + b.drawn});
    inside = longer;
  }
  cuts.insert(cuts.end(), inside.begin(), inside.end());
  return cuts;
}

TEST(cell_sizes, no_choice_of_as_few_cells_draws_less) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    block_options block([&](const square&) { return static_cast<double>(random() % 100); }, 2);
    for (std::size_t i = 0; i < block.options.size(); ++i) {
      if (block.options[i].smallest) continue;
      block.options[i].drawn = 0.0;
      for (std::size_t below = 0; below < i; ++below)
        if (block.options[below].parent == i)
          block.options[i].drawn += block.options[below].drawn * static_cast<double>(100 + random() % 60) / 100.0;
    }
    const double growth = static_cast<double>(random() % 40) / 100.0;
    const auto chosen = choose_cell_sizes(block.options, growth);
    double drawn = 0.0, smallest = 0.0;
    for (const cell_option& option : block.options) smallest += option.smallest ? option.drawn : 0.0;
    for (const std::size_t i : chosen) drawn += block.options[i].drawn;
    EXPECT_LE(drawn, (1.0 + growth) * smallest + 1e-9);
    for (const cut& other : all_cuts(block, block.options.size() - 1)) {
      if (other.cells > chosen.size()) continue;
      EXPECT_GE(other.drawn, drawn - 1e-9) << round;
    }
  }
}

}  // namespace
}  // namespace sightcell::bake
