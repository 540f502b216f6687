#include "order/tour.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "order/improve_tour.h"

namespace sightcell::bake {
namespace {

using numbers = std::vector<std::uint32_t>;

// The last two rows, where paths begin and end, stay empty if open.
bit_matrix random_rows(std::uint32_t rows, std::uint32_t columns, std::uint32_t seed, bool open = false) {
  bit_matrix m(rows, columns);
  std::mt19937 random(seed);
  for (std::uint32_t r = 0; r < rows - (open ? 2 : 0); ++r)
    for (std::uint32_t c = 0; c < columns; ++c)
      if (random() % 3 == 0) m.toggle(r, c);
  return m;
}

// Rows of a shuffled line: column c is set in an interval of it that begins at place c, so no two rows are alike. The
// best path has two changes per column.
bit_matrix shuffled_line(std::uint32_t rows, std::uint32_t seed) {
  std::mt19937 random(seed);
  numbers row_at(rows);
  std::iota(row_at.begin(), row_at.end(), 0u);
  std::shuffle(row_at.begin(), row_at.end(), random);
  bit_matrix m(rows + 2, rows);
  for (std::uint32_t c = 0; c < rows; ++c) {
    const std::uint32_t end = std::min(rows, c + 1 + static_cast<std::uint32_t>(random() % (rows / 8)));
    for (std::uint32_t i = c; i < end; ++i) m.toggle(row_at[i], c);
  }
  return m;
}

std::int64_t length_of(const bit_matrix& m, const numbers& path) {
  std::uint32_t at = m.rows() - 2;
  std::int64_t length = 0;
  for (const std::uint32_t next : path) length += m.distance(std::exchange(at, next), next);
  return length + m.distance(at, m.rows() - 1);
}

std::int64_t optimum(const bit_matrix& m) {
  numbers path(m.rows() - 2);
  std::iota(path.begin(), path.end(), 0u);
  std::int64_t best = std::numeric_limits<std::int64_t>::max();
  do best = std::min(best, length_of(m, path));
  while (std::next_permutation(path.begin(), path.end()));
  return best;
}

void expect_permutation(numbers order, std::uint32_t count) {
  std::sort(order.begin(), order.end());
  numbers all(count);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(order, all);
}

TEST(tour, few_rows_are_close_to_the_optimum) {
  std::int64_t found = 0, best = 0;
  for (std::uint32_t rows = 0; rows <= 6; ++rows)
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
      const bit_matrix m = random_rows(rows + 2, 40, seed, seed % 2 == 0);
      const numbers path = shortest_path(m, {});
      expect_permutation(path, rows);
      const std::int64_t length = length_of(m, path), shortest = optimum(m);
      EXPECT_LE(static_cast<double>(length), 1.1 * static_cast<double>(shortest)) << rows << " rows, seed " << seed;
      found += length;
      best += shortest;
    }
  EXPECT_LE(static_cast<double>(found), 1.01 * static_cast<double>(best));
}

TEST(tour, a_shuffled_line_is_found_again) {
  for (const std::uint32_t rows : {30u, 400u, 3000u}) {
    const bit_matrix m = shuffled_line(rows, rows);
    const numbers path = shortest_path(m, {});
    expect_permutation(path, rows);
    EXPECT_LE(static_cast<double>(length_of(m, path)), 1.05 * 2 * rows) << rows;
  }
}

// Nothing is near to anything: no candidate is better than another, and fragments have to be joined by sorts.
TEST(tour, rows_that_are_all_equally_far_apart_make_one_path) {
  bit_matrix m(5002, 5000);
  for (std::uint32_t r = 0; r < 5000; ++r) m.toggle(r, r);
  expect_permutation(shortest_path(m, {.sorts = 1, .neighbors = 1}), 5000);
  // Pairs know each other alone, and without sorts nobody proposes more: joining makes its own.
  bit_matrix pairs(5002, 2500);
  for (std::uint32_t r = 0; r < 5000; ++r) pairs.toggle(r, r / 2);
  expect_permutation(shortest_path(pairs, {.sorts = 0, .neighbors = 1}), 5000);
}

TEST(tour, paths_are_fitted_to_where_they_begin_and_end) {
  bit_matrix m = shuffled_line(300, 5);
  const numbers path = shortest_path(m, {});
  // Whoever is in the middle of the line now lies at its ends.
  for (std::uint32_t c = 0; c < 300; ++c) {
    if (m.get(path[140], c)) m.toggle(300, c);
    if (m.get(path[160], c)) m.toggle(301, c);
  }
  const numbers improved = improved_path(m, path, {});
  expect_permutation(improved, 300);
  EXPECT_LT(length_of(m, improved), length_of(m, path));
}

TEST(tour, a_fixed_edge_is_never_broken) {
  for (std::uint32_t rows = 2; rows < 60; ++rows)
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
      const bit_matrix m = random_rows(rows, 64, 100 * rows + seed);
      numbers tour(rows);
      std::iota(tour.begin(), tour.end(), 0u);
      std::shuffle(tour.begin(), tour.end(), std::mt19937(seed));
      // A far one, which a search would rather not keep.
      std::size_t far = 0;
      for (std::size_t i = 0; i + 1 < rows; ++i)
        if (m.distance(tour[i], tour[i + 1]) > m.distance(tour[far], tour[far + 1])) far = i;
      const tour_edge fixed{tour[far], tour[far + 1]};
      const auto length = [&] {
        std::int64_t sum = m.distance(tour.back(), tour.front());
        for (std::size_t i = 0; i + 1 < rows; ++i) sum += m.distance(tour[i], tour[i + 1]);
        return sum;
      };
      const std::int64_t before = length();
      numbers all(rows);
      std::iota(all.begin(), all.end(), 0u);
      improve_tour(m, neighbors_by_sorts(m, all, 8, 16, 1), fixed, tour);
      expect_permutation(tour, rows);
      EXPECT_LE(length(), before);
      bool kept = fixed.joins(tour.back(), tour.front());
      for (std::size_t i = 0; i + 1 < rows; ++i) kept |= fixed.joins(tour[i], tour[i + 1]);
      EXPECT_TRUE(kept) << rows << " rows, seed " << seed;
    }
}

TEST(tour, neighbors_are_sorted_and_known_once) {
  neighbor_lists near(1, 3);
  near.add(0, 7, 5);
  near.add(0, 8, 4);
  near.add(0, 7, 5);
  EXPECT_EQ(near.of(0)[2].row, no_row);
  near.add(0, 9, 5);
  near.add(0, 6, 5);  // comes too late
  near.add(0, 5, 1);
  numbers rows;
  for (const near_row& n : near.of(0)) rows.push_back(n.row);
  EXPECT_EQ(rows, (numbers{5, 8, 7}));
}

TEST(tour, the_number_of_threads_changes_nothing) {
  const bit_matrix m = random_rows(20000, 64, 3);  // loops of this length are shared
  std::vector<numbers> paths;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    paths.push_back(shortest_path(m, {.sorts = 4}));
  }
  expect_permutation(paths[0], 19998);
  EXPECT_EQ(paths[0], paths[1]);
  EXPECT_EQ(paths[0], paths[2]);
}

TEST(bit_matrix, columns_are_rounded_up_and_folded_only_if_they_are_more) {
  const bit_matrix m(3, 65);
  EXPECT_EQ(m.columns(), 128u);
  EXPECT_EQ(bit_matrix(1, 0).columns(), 64u);
  EXPECT_EQ(folded_column(127, 128, m), 127u);
  std::vector<int> hits(128);
  for (std::uint32_t c = 0; c < 12800; ++c) ++hits[folded_column(c, 12800, m)];
  EXPECT_GT(*std::ranges::min_element(hits), 50);
  EXPECT_LT(*std::ranges::max_element(hits), 150);
}

}  // namespace
}  // namespace sightcell::bake
