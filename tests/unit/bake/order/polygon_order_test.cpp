#include "order/polygon_order.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>

namespace sightcell::bake {
namespace {

using numbers = std::vector<std::uint32_t>;
using runs_type = std::vector<format::run>;

// Runs of a set given as one flag per polygon.
runs_type runs_of(const std::vector<bool>& seen) {
  runs_type runs;
  for (std::uint32_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) continue;
    if (i > 0 && seen[i - 1])
      ++runs.back().count;
    else
      runs.push_back({.first = i, .count = 1});
  }
  return runs;
}

struct made_up {
  std::vector<ordered_draw> draws;
  std::uint32_t unit_count = 0;
  std::vector<std::vector<bool>> sets;  // by cell

  std::uint32_t polygon_count() const { return draws.empty() ? 0 : draws.back().first + draws.back().count; }
  std::uint32_t add_draw(std::uint32_t unit, std::uint32_t count) {
    draws.push_back({.unit = unit, .first = polygon_count(), .count = count});
    unit_count = std::max(unit_count, unit + 1);
    return draws.back().first;
  }
  std::vector<bool>& add_cell() { return sets.emplace_back(polygon_count()); }

  polygon_order order(const order_settings& how = {}) const {
    const order_input in{.draws = draws,
                         .unit_count = unit_count,
                         .cell_count = static_cast<std::uint32_t>(sets.size()),
                         .runs_of = [&](std::uint32_t cell, runs_type& runs) {
                           EXPECT_TRUE(runs.empty());
                           runs = bake::runs_of(sets[cell]);
                         }};
    return order_polygons(in, how);
  }
  std::size_t runs_in_source_order() const {
    std::size_t sum = 0;
    for (const std::vector<bool>& set : sets) sum += bake::runs_of(set).size();
    return sum;
  }
};

void expect_permutation(numbers order, std::uint32_t count) {
  std::sort(order.begin(), order.end());
  numbers all(count);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(order, all);
}

void expect_valid(const made_up& scene, const polygon_order& order) {
  ASSERT_EQ(order.units.size(), scene.unit_count);
  numbers counts(scene.unit_count);
  for (const ordered_draw& draw : scene.draws) counts[draw.unit] = draw.count;
  for (std::uint32_t u = 0; u < scene.unit_count; ++u) expect_permutation(order.units[u], counts[u]);
  expect_permutation(order.draws, static_cast<std::uint32_t>(scene.draws.size()));
}

// Of all sets together, in the order that was found.
std::size_t count_runs(const made_up& scene, const polygon_order& order) {
  std::size_t sum = 0;
  for (const std::vector<bool>& set : scene.sets) {
    std::vector<bool> stored;
    for (const std::uint32_t d : order.draws)
      if (scene.draws[d].count != 0)
        for (const std::uint32_t polygon : order.units[scene.draws[d].unit])
          stored.push_back(set[scene.draws[d].first + polygon]);
    sum += runs_of(stored).size();
  }
  return sum;
}

std::size_t ordered_runs(const made_up& scene, const order_settings& how = {}) {
  const polygon_order order = scene.order(how);
  expect_valid(scene, order);
  return count_runs(scene, order);
}

numbers shuffled(std::uint32_t count, std::uint32_t seed) {
  numbers order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

// One draw; each cell sees an interval of the line that its polygons are when polygon_at is followed.
made_up shuffled_line(std::uint32_t polygons, std::uint32_t cells, std::uint32_t seed) {
  made_up scene;
  scene.add_draw(0, polygons);
  const numbers polygon_at = shuffled(polygons, seed);
  std::mt19937 random(seed + 1);
  for (std::uint32_t c = 0; c < cells; ++c) {
    std::vector<bool>& set = scene.add_cell();
    const auto begin = static_cast<std::uint32_t>(random() % polygons);
    const std::uint32_t end = std::min(polygons, begin + 1 + static_cast<std::uint32_t>(random() % (polygons / 8)));
    for (std::uint32_t i = begin; i < end; ++i) set[polygon_at[i]] = true;
  }
  return scene;
}

// Draws of random counts, some of one unit, and cells that see random discs of a plane in which draws lie.
made_up random_scene(std::uint32_t seed) {
  made_up scene;
  std::mt19937 random(seed);
  const auto up_to = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % most); };
  numbers counts;
  for (std::uint32_t u = 0; u < 12; ++u) counts.push_back(u < 2 ? u : 1 + up_to(60));
  for (std::uint32_t d = 0; d < 30; ++d) {
    const std::uint32_t unit = d < 12 ? d : 6 + up_to(6);  // the first six are not shared
    scene.add_draw(unit, counts[unit]);
  }
  std::vector<std::pair<int, int>> places;
  for (const ordered_draw& draw : scene.draws) {
    const int x = static_cast<int>(up_to(100)), y = static_cast<int>(up_to(100));
    std::mt19937 inside(draw.unit);
    for (std::uint32_t i = 0; i < draw.count; ++i)
      places.emplace_back(x + static_cast<int>(inside() % 30), y + static_cast<int>(inside() % 30));
  }
  for (int c = 0; c < 80; ++c) {
    std::vector<bool>& set = scene.add_cell();
    const int x = static_cast<int>(up_to(130)), y = static_cast<int>(up_to(130));
    for (std::size_t i = 0; i < places.size(); ++i) {
      const int dx = places[i].first - x, dy = places[i].second - y;
      set[i] = dx * dx + dy * dy < 900;
    }
  }
  return scene;
}

TEST(polygon_order, a_shuffled_line_is_found_again) {
  const made_up scene = shuffled_line(3000, 400, 1);
  const std::size_t runs = ordered_runs(scene);
  EXPECT_LE(static_cast<double>(runs), 1.05 * 400);
  EXPECT_GT(scene.runs_in_source_order(), 100 * runs);
}

TEST(polygon_order, wide_signatures_are_folded) {
  const made_up scene = shuffled_line(1000, 700, 2);
  const std::size_t runs = ordered_runs(scene, {.sketch_bits = 128});
  EXPECT_GT(scene.runs_in_source_order(), 20 * runs);
}

TEST(polygon_order, random_scenes_are_ordered_and_rounds_help) {
  std::size_t source = 0, none = 0, two = 0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const made_up scene = random_scene(seed);
    source += scene.runs_in_source_order();
    none += ordered_runs(scene, {.rounds = 0});
    two += ordered_runs(scene, {.rounds = 2});
  }
  EXPECT_GT(source, 2 * none);
  EXPECT_LT(100 * two, 99 * none);
}

// Whoever has the same signature stays together, in source order.
TEST(polygon_order, atoms_stay_together) {
  made_up scene;
  scene.add_draw(0, 12);
  for (std::uint32_t c = 0; c < 3; ++c) {
    std::vector<bool>& set = scene.add_cell();
    for (std::uint32_t i = 0; i < 12; ++i) set[i] = i % 4 == c;
  }
  const polygon_order order = scene.order();
  expect_valid(scene, order);
  for (std::size_t i = 0; i < 12; i += 3) {
    const numbers three(order.units[0].begin() + static_cast<int>(i), order.units[0].begin() + static_cast<int>(i) + 3);
    const bool up = three == numbers{three[0], three[0] + 4, three[0] + 8};
    const bool down = three == numbers{three[0], three[0] - 4, three[0] - 8};
    EXPECT_TRUE(up || down) << i;
  }
}

// Cells of the first half see one instance, the others the other: both have to be taken into account.
TEST(polygon_order, one_order_serves_all_instances) {
  constexpr std::uint32_t count = 400;
  const made_up line = shuffled_line(count, 120, 3);
  made_up scene;
  scene.add_draw(0, count);
  scene.add_draw(0, count);
  for (std::size_t c = 0; c < line.sets.size(); ++c) {
    std::vector<bool>& set = scene.add_cell();
    std::copy(line.sets[c].begin(), line.sets[c].end(), set.begin() + (c % 2 == 0 ? 0 : count));
  }
  EXPECT_LE(static_cast<double>(ordered_runs(scene)), 1.05 * 120);
}

// What one cell sees of two instances are two bits of a signature, which must not cancel each other out.
TEST(polygon_order, cells_may_see_the_same_of_several_instances) {
  made_up scene;
  scene.add_draw(0, 6);
  scene.add_draw(0, 6);
  std::vector<bool>& set = scene.add_cell();
  for (const std::uint32_t i : {0, 2, 4}) set[i] = set[6 + i] = true;
  EXPECT_EQ(ordered_runs(scene), 2u);
}

// Three walls, each a line; cells look round the two corners between them.
TEST(polygon_order, draws_are_laid_end_to_end) {
  constexpr std::uint32_t count = 60;
  made_up scene;
  for (std::uint32_t u = 0; u < 3; ++u) scene.add_draw(u, count);
  const numbers order = shuffled(count, 4);
  const auto polygon_at = [&](std::uint32_t i) {  // on the way 0, 2, 1
    const std::uint32_t draw = i / count == 0 ? 0 : 3 - i / count;
    return draw * count + order[draw == 2 ? count - 1 - i % count : i % count];
  };
  for (std::uint32_t i = 0; i + 10 <= 3 * count; ++i) {
    std::vector<bool>& set = scene.add_cell();
    for (std::uint32_t k = i; k < i + 10; ++k) set[polygon_at(k)] = true;
  }
  EXPECT_EQ(ordered_runs(scene), scene.sets.size());
}

// Twenty cells see where the first and the third instance end, ten the end of the first and the beginning of the
// second. The twenty would be served by turning one instance round, which cannot be done.
TEST(polygon_order, instances_are_not_flipped) {
  made_up scene;
  for (int d = 0; d < 3; ++d) scene.add_draw(0, 9);
  const auto add_cells = [&](int count, numbers polygons) {
    for (int c = 0; c < count; ++c) {
      std::vector<bool>& set = scene.add_cell();
      for (const std::uint32_t polygon : polygons) set[polygon] = true;
    }
  };
  for (std::uint32_t i = 0; i + 2 <= 9; ++i) add_cells(40, {i, i + 1});  // the line that the unit is
  add_cells(20, {8, 26});
  add_cells(10, {8, 9});
  EXPECT_EQ(ordered_runs(scene), 8u * 40 + 20 * 2 + 10);
}

TEST(polygon_order, the_number_of_threads_changes_nothing) {
  // A unit of so many atoms that it is worked on with all threads, and many that are worked on side by side.
  made_up scene = shuffled_line(20000, 80, 5);
  std::mt19937 random(6);
  for (std::vector<bool>& set : scene.sets)
    for (std::size_t i = 0; i < set.size(); ++i) set[i] = set[i] != (random() % 8 == 0);
  const made_up small = random_scene(9);
  for (const ordered_draw& draw : small.draws) scene.add_draw(1 + draw.unit, draw.count);
  for (std::size_t c = 0; c < scene.sets.size(); ++c)
    scene.sets[c].insert(scene.sets[c].end(), small.sets[c].begin(), small.sets[c].end());
  std::vector<polygon_order> orders;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    orders.push_back(scene.order({.sorts = 4}));
  }
  expect_valid(scene, orders[0]);
  for (const polygon_order& other : orders) {
    EXPECT_EQ(other.units, orders[0].units);
    EXPECT_EQ(other.draws, orders[0].draws);
  }
}

TEST(polygon_order, nothing_to_order) {
  EXPECT_TRUE(made_up().order().draws.empty());

  made_up no_cells;
  no_cells.add_draw(0, 5);
  no_cells.add_draw(2, 1);  // nobody draws unit 1
  expect_valid(no_cells, no_cells.order());

  made_up empty_cell = no_cells;
  empty_cell.add_cell();
  expect_valid(empty_cell, empty_cell.order());

  made_up only_empty;
  only_empty.add_draw(0, 0);
  only_empty.add_draw(0, 0);
  only_empty.add_cell();
  EXPECT_EQ(only_empty.order().draws, (numbers{0, 1}));
}

TEST(polygon_order, empty_draws_come_last) {
  made_up scene;
  scene.add_draw(0, 0);
  scene.add_draw(1, 3);
  scene.add_draw(2, 0);
  scene.add_draw(1, 3);
  scene.add_cell()[1] = true;
  const polygon_order order = scene.order();
  expect_valid(scene, order);
  EXPECT_EQ(numbers(order.draws.begin() + 2, order.draws.end()), (numbers{0, 2}));
}

TEST(polygon_order, everything_and_nothing_visible) {
  made_up scene;
  scene.add_draw(0, 50);
  scene.add_draw(1, 1);
  scene.add_draw(0, 50);
  for (int c = 0; c < 4; ++c) scene.add_cell().assign(101, c % 2 == 0);
  EXPECT_EQ(ordered_runs(scene), 2u);
  numbers source(50);
  std::iota(source.begin(), source.end(), 0u);
  const numbers found = scene.order().units[0];
  EXPECT_EQ(found, source);  // one atom
}

TEST(polygon_order, units_of_few_atoms) {
  for (std::uint32_t atoms = 1; atoms <= 4; ++atoms) {
    made_up scene;
    for (std::uint32_t d = 0; d < 5; ++d) scene.add_draw(d / 2, 8);  // shared ones and one that is not
    for (std::uint32_t c = 0; c < 6; ++c) {
      std::vector<bool>& set = scene.add_cell();
      for (std::uint32_t i = 0; i < 40; ++i) set[i] = (i * atoms / 8 + c) % atoms == 0 && i / 8 != c;
    }
    EXPECT_LE(ordered_runs(scene), scene.runs_in_source_order());
  }
}

TEST(polygon_order, draws_of_one_polygon) {
  made_up scene;
  for (std::uint32_t d = 0; d < 40; ++d) scene.add_draw(d < 20 ? 0 : d, 1);
  const numbers polygon_at = shuffled(40, 6);
  for (std::uint32_t c = 0; c + 5 <= 40; ++c) {
    std::vector<bool>& set = scene.add_cell();
    for (std::uint32_t i = c; i < c + 5; ++i) set[polygon_at[i]] = true;
  }
  EXPECT_LE(static_cast<double>(ordered_runs(scene)), 1.15 * static_cast<double>(scene.sets.size()));
}

TEST(polygon_order, settings_at_their_limits) {
  const made_up scene = random_scene(11);
  const std::size_t source = scene.runs_in_source_order();
  EXPECT_LT(ordered_runs(scene, {.sorts = 0, .neighbors = 0, .sketch_bits = 0, .rounds = 1}), 2 * source);
  EXPECT_LT(ordered_runs(scene, {.sorts = 2, .neighbors = 100, .sketch_bits = 1u << 31, .rounds = 4}), source / 2);
}

TEST(polygon_order, what_the_reader_throws_comes_through) {
  made_up scene;
  scene.add_draw(0, 5);
  const order_input in{
      .draws = scene.draws, .unit_count = 1, .cell_count = 1, .runs_of = [](std::uint32_t, runs_type&) {
        throw std::runtime_error("disk");
      }};
  EXPECT_THROW(order_polygons(in, {}), std::runtime_error);
}

}  // namespace
}  // namespace sightcell::bake
