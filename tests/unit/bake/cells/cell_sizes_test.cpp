#include "cells/cell_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "cells/lattice.h"

namespace sightcell::bake {
namespace {

// A block of 8 x 8 cells and all squares in it. Each cell of level 0 has an area of 1.
std::vector<cell_option> block(const std::function<double(const lattice_position&)>& polygons_seen) {
  std::vector<cell_option> options;
  for (std::int32_t level = 0; level <= 3; ++level)
    for (std::int64_t z = 0; z < 8 >> level; ++z)
      for (std::int64_t x = 0; x < 8 >> level; ++x) {
        const lattice_position at{.z = z, .y = 0, .x = x, .level = level};
        options.push_back({at, static_cast<double>(1 << 2 * level) * polygons_seen(at)});
      }
  return options;
}

TEST(cell_sizes, cells_that_see_the_same_become_one) {
  const auto chosen = choose_cell_sizes(block([](const lattice_position&) { return 100.0; }), 0.0);
  ASSERT_EQ(chosen.size(), 1u);
  EXPECT_EQ(chosen[0], (lattice_position{.level = 3}));
}

TEST(cell_sizes, cells_that_see_different_things_stay) {
  // Twice as many from each larger square; a little more further back.
  const auto twice = [](const lattice_position& at) {
    return 100.0 * (1 << at.level) + (at.level > 0 ? 0.1 * static_cast<double>(at.z * 8 + at.x) : 0.0);
  };
  EXPECT_EQ(choose_cell_sizes(block(twice), 0.0701).size(), 61u) << "one square of four costs 4 / 64 x 100 % more";
  EXPECT_EQ(choose_cell_sizes(block(twice), 0.01).size(), 64u);
  EXPECT_EQ(choose_cell_sizes(block(twice), 7.0).size(), 1u);
}

// A wall between x = 3 and x = 4: squares across it see what is on both sides.
TEST(cell_sizes, nothing_merges_across_a_wall) {
  const auto seen = [](const lattice_position& at) { return at.level == 3 ? 200.0 : 100.0; };
  const auto chosen = choose_cell_sizes(block(seen), 0.1);
  ASSERT_EQ(chosen.size(), 4u);
  for (const lattice_position& at : chosen) EXPECT_EQ(at.level, 2);
}

// What is left of a block where no square was estimated, and a square of which only one quarter has cells.
TEST(cell_sizes, squares_without_an_estimate_are_not_chosen) {
  std::vector<cell_option> options{{{.z = 5, .x = 1}, 10.0},
                                   {{.z = 0, .x = 0}, 10.0},
                                   {{.z = 1, .x = 1}, 10.0},
                                   {{.z = 0, .x = 0, .level = 3}, 31.0}};
  EXPECT_EQ(choose_cell_sizes(options, 0.0).size(), 3u);
  EXPECT_EQ(choose_cell_sizes(options, 0.1), (std::vector<lattice_position>{{.z = 0, .x = 0, .level = 3}}));
  options.pop_back();
  EXPECT_EQ(choose_cell_sizes(options, 9.0).size(), 3u);
  EXPECT_TRUE(choose_cell_sizes({}, 0.1).empty());
}

// All ways to cut a square of level 2, as cells and what is drawn.
struct cut {
  std::size_t cells = 0;
  double drawn = 0.0;
};

std::vector<cut> all_cuts(const std::vector<cell_option>& options, const lattice_position& root) {
  const auto drawn = [&](const lattice_position& at) {
    return std::find_if(options.begin(), options.end(), [&](const cell_option& o) { return o.position == at; })->drawn;
  };
  std::vector<cut> cuts{{1, drawn(root)}};
  if (root.level == 0) return cuts;
  std::vector<cut> inside{{0, 0.0}};
  for (std::int64_t i = 0; i < 4; ++i) {
    const auto of_part =
        all_cuts(options, {.z = 2 * root.z + i / 2, .y = root.y, .x = 2 * root.x + i % 2, .level = root.level - 1});
    std::vector<cut> longer;
    for (const cut& a : inside)
      for (const cut& b : of_part) longer.push_back({a.cells + b.cells, a.drawn + b.drawn});
    inside = longer;
  }
  cuts.insert(cuts.end(), inside.begin(), inside.end());
  return cuts;
}

TEST(cell_sizes, no_choice_of_as_few_cells_draws_less) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<cell_option> options;
    for (std::int64_t x = 0; x < 16; ++x)
      options.push_back({{.z = x / 4, .y = -3, .x = x % 4 - 4}, static_cast<double>(random() % 100)});
    for (std::int32_t level = 1; level <= 2; ++level)
      for (const cell_option& below : std::vector(options)) {
        if (below.position.level != level - 1) continue;
        const lattice_position at = lattice::wider(below.position);
        const auto known =
            std::find_if(options.begin(), options.end(), [&](const cell_option& o) { return o.position == at; });
        const double more = below.drawn * static_cast<double>(100 + random() % 60) / 100.0;
        if (known == options.end())
          options.push_back({at, more});
        else
          known->drawn += more;
      }
    std::shuffle(options.begin(), options.end(), random);
    const double growth = static_cast<double>(random() % 40) / 100.0;
    const auto chosen = choose_cell_sizes(options, growth);
    double drawn = 0.0, leaves = 0.0;
    for (const cell_option& option : options) {
      if (option.position.level == 0) leaves += option.drawn;
      if (std::binary_search(chosen.begin(), chosen.end(), option.position)) drawn += option.drawn;
    }
    EXPECT_LE(drawn, (1.0 + growth) * leaves + 1e-9);
    for (const cut& other : all_cuts(options, {.z = 0, .y = -3, .x = -1, .level = 2})) {
      if (other.cells > chosen.size()) continue;
      EXPECT_GE(other.drawn, drawn - 1e-9) << round;
    }
    std::reverse(options.begin(), options.end());
    EXPECT_EQ(choose_cell_sizes(options, growth), chosen);
  }
}

}  // namespace
}  // namespace sightcell::bake
