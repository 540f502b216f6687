#include "order/draw_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace sightcell::bake {
namespace {

using numbers = std::vector<std::uint32_t>;
using flags = std::vector<std::uint8_t>;

bit_matrix random_ends(std::uint32_t draws, std::uint32_t seed) {
  bit_matrix ends(2 * draws + 1, 100);
  std::mt19937 random(seed);
  for (std::uint32_t end = 0; end < 2 * draws; ++end)
    for (std::uint32_t c = 0; c < 100; ++c)
      if (random() % 4 == 0) ends.toggle(end, c);
  return ends;
}

std::int64_t length_of(const bit_matrix& ends, const numbers& entries) {
  const std::uint32_t nothing = ends.rows() - 1;
  std::uint32_t at = nothing;
  std::int64_t length = 0;
  for (const std::uint32_t entry : entries) {
    length += ends.distance(at, entry);
    at = other_end(entry);
  }
  return length + ends.distance(at, nothing);
}

void expect_all_draws(const numbers& entries, const flags& flippable) {
  numbers draws;
  for (const std::uint32_t entry : entries) {
    draws.push_back(draw_of(entry));
    if (flippable[draw_of(entry)] == 0) {
      EXPECT_EQ(entry, head_of(draw_of(entry)));
    }
  }
  std::sort(draws.begin(), draws.end());
  numbers all(flippable.size());
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(draws, all);
}

// Two draws whose tails the same cells see.
bit_matrix like_tails() {
  bit_matrix ends(5, 64);
  for (std::uint32_t c = 0; c < 10; ++c) ends.toggle(tail_of(0), c), ends.toggle(tail_of(1), c);
  return ends;
}

TEST(draw_tour, draws_are_flipped_where_that_is_allowed) {
  const bit_matrix ends = like_tails();
  const draw_tour both(ends, flags{1, 1}, 4), one(ends, flags{1, 0}, 4), none(ends, flags{0, 0}, 4);
  EXPECT_EQ(length_of(ends, both.entries()), 0);
  EXPECT_EQ(length_of(ends, one.entries()), 0);
  EXPECT_EQ(one.entries(), (numbers{head_of(1), tail_of(0)}));
  EXPECT_EQ(length_of(ends, none.entries()), 20);
  for (const std::uint32_t entry : none.entries()) EXPECT_EQ(entry % 2, 0u);
}

// Brute force over orders and flips.
TEST(draw_tour, few_draws_are_close_to_the_optimum) {
  std::int64_t found = 0, best = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const std::uint32_t count = 1 + seed % 5;
    const bit_matrix ends = random_ends(count, seed);
    flags flippable(count);
    for (std::uint32_t d = 0; d < count; ++d) flippable[d] = (seed >> d) & 1;
    const draw_tour tour(ends, flippable, 4);
    expect_all_draws(tour.entries(), flippable);
    std::int64_t shortest = length_of(ends, tour.entries());
    found += shortest;
    for (std::uint32_t flips = 0; flips < 1u << count; ++flips) {
      numbers order(count);
      std::iota(order.begin(), order.end(), 0u);
      do {
        numbers entries;
        for (const std::uint32_t d : order) entries.push_back(2 * d + ((flips >> d) & flippable[d]));
        shortest = std::min(shortest, length_of(ends, entries));
      } while (std::next_permutation(order.begin(), order.end()));
    }
    best += shortest;
  }
  EXPECT_LE(static_cast<double>(found), 1.03 * static_cast<double>(best));
}

// What is known of the optimum: draws of a shuffled line, each seen where it begins and ends.
TEST(draw_tour, a_shuffled_line_is_found_again) {
  for (const bool flip : {false, true}) {
    constexpr std::uint32_t count = 500;
    std::mt19937 random(7);
    numbers draw_at(count);
    std::iota(draw_at.begin(), draw_at.end(), 0u);
    std::shuffle(draw_at.begin(), draw_at.end(), random);
    bit_matrix ends(2 * count + 1, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t turned = flip ? static_cast<std::uint32_t>(random() % 2) : 0;
      for (std::uint32_t c = i; c < std::min(count, i + 20); ++c) ends.toggle(head_of(draw_at[i]) + turned, c);
      for (std::uint32_t c = i + 1; c < std::min(count, i + 21); ++c)
        ends.toggle(other_end(head_of(draw_at[i]) + turned), c);
    }
    const flags flippable(count, flip ? 1 : 0);
    const draw_tour tour(ends, flippable, 16);
    expect_all_draws(tour.entries(), flippable);
    EXPECT_LE(length_of(ends, tour.entries()), 30) << flip;  // 21: what the first draw costs
  }
}

TEST(draw_tour, improving_never_makes_it_longer) {
  const flags flippable = [] {
    flags f(80);
    for (std::size_t i = 0; i < f.size(); ++i) f[i] = i % 3 == 0;
    return f;
  }();
  draw_tour tour(random_ends(80, 1), flippable, 4);
  for (std::uint32_t seed = 2; seed < 6; ++seed) {
    const bit_matrix changed = random_ends(80, seed);
    const std::int64_t before = length_of(changed, tour.entries());
    tour.improve(changed);
    expect_all_draws(tour.entries(), flippable);
    EXPECT_LT(length_of(changed, tour.entries()), before);
  }
}

// More than are looked at in pairs; heads that are all alike and far from all tails; and nothing seen at all.
TEST(draw_tour, many_draws_make_one_path) {
  constexpr std::uint32_t count = 7000;
  for (const std::uint8_t flip : {std::uint8_t{0}, std::uint8_t{1}}) {
    const flags flippable(count, flip);
    bit_matrix ends(2 * count + 1, 64);
    expect_all_draws(draw_tour(ends, flippable, 4).entries(), flippable);
    for (std::uint32_t d = 0; d < count; ++d)
      for (std::uint32_t c = 0; c < 40; ++c) ends.toggle(head_of(d), c);
    expect_all_draws(draw_tour(ends, flippable, 4).entries(), flippable);
  }
  EXPECT_TRUE(draw_tour(bit_matrix(1, 64), flags{}, 4).entries().empty());
}

}  // namespace
}  // namespace sightcell::bake
