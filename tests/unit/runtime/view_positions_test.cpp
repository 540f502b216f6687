// Positions other than one eye in one cell: boxes, origins far away, outside all cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "loaded_file.h"
#include "unit/case_step.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;
using sightcell::format::box;

constexpr std::uint32_t all_flags = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE;

sightcell_frame move_box(const test_view& view, const std::array<float, 3>& min, const std::array<float, 3>& max,
                         sightcell_status expected = SIGHTCELL_OK) {
  sightcell_frame frame;
  EXPECT_EQ(sightcell_view_move_box(view.get(), min.data(), max.data(), &frame), expected);
  return frame;
}

// Four cells of 4 m in a row, margin 0.25. Polygons 2 i and 2 i + 1 are visible from cell i.
sample_contents row_of_cells() {
  sample_contents contents;
  add_draws(contents, 40, 4);
  contents.facts.margin = 0.25f;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto x = 4.0f * static_cast<float>(i);
    contents.cells.push_back({{x, 0, 0}, {x + 4, 2, 4}});
    contents.sets.push_back({2 * i, 2 * i + 1});
  }
  return contents;
}

TEST(view_positions, a_box_in_a_grown_box_is_one_cell) {
  const sample_contents contents = row_of_cells();
  const loaded_file file(contents);
  const test_view view(file.db());
  EXPECT_EQ(move_box(view, {3.9f, 1, 1}, {4.05f, 1, 1}).cell, 0u) << "two eyes on a threshold";
  EXPECT_EQ(view.polygons(), contents.sets[0]);
  EXPECT_EQ(move_box(view, {3.9f, 1, 1}, {4.2f, 1, 1}).cell, 0u) << "kept while the grown box contains both";
  EXPECT_EQ(move_box(view, {4.0f, 1, 1}, {4.24f, 1, 1}).cell, 0u);
  EXPECT_EQ(move_box(view, {4.1f, 1, 1}, {4.5f, 1, 1}).cell, 1u);
  EXPECT_EQ(view.polygons(), contents.sets[1]);
}

TEST(view_positions, a_larger_box_has_the_union_of_its_cells) {
  const sample_contents contents = row_of_cells();
  const loaded_file file(contents);
  test_view view(file.db());
  const sightcell_frame frame = move_box(view, {3, 1, 1}, {5, 1.5f, 2});
  EXPECT_EQ(view.polygons(), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(polygons_of(view.ranges(), contents), view.polygons());
  EXPECT_EQ(frame.flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_CHANGED));
  EXPECT_EQ(frame.polygon_count, 4u);
  EXPECT_EQ(frame.cell, 1u) << "the cell of the center";
  EXPECT_EQ(move_box(view, {3, 1, 1}, {5.5f, 1.5f, 2}).flags, 0u) << "the same cells, the same set";
  EXPECT_EQ(move_box(view, {3, 1, 1}, {8, 1.5f, 2}).polygon_count, 6u) << "both ends are in the box";
  EXPECT_EQ(view.move(6, 1, 1).polygon_count, 2u);
  EXPECT_EQ(view.polygons(), contents.sets[1]) << "an eye after a box";
  EXPECT_EQ(move_box(view, {1, 1, 1}, {1, 1, 1}).cell, 0u) << "a box that is a point";
}

TEST(view_positions, a_box_that_leaves_the_cells) {
  const sample_contents contents = row_of_cells();
  const loaded_file file(contents);
  const test_view view(file.db());
  EXPECT_EQ(move_box(view, {-0.2f, 1, 1}, {5, 1, 1}).flags & all_flags, 0u) << "grown boxes still contain it";
  EXPECT_EQ(move_box(view, {-0.3f, 1, 1}, {5, 1, 1}).flags & all_flags, all_flags);
  EXPECT_EQ(view.polygons().size(), 40u);
  EXPECT_EQ(move_box(view, {3, 2.1f, 1}, {5, 2.2f, 1}).flags & all_flags, all_flags) << "in no cell, above them";
  EXPECT_EQ(move_box(view, {14, 1, 1}, {16.25f, 1, 1}).flags & all_flags, all_flags) << "on the end, which is outside";
  EXPECT_EQ(move_box(view, {11, 1, 1}, {16.2f, 1, 1}).flags & all_flags, 0u);
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, 1.0f), SIGHTCELL_OK);
  const sightcell_frame partly = move_box(view, {-0.3f, 1, 1}, {5, 1, 1});
  EXPECT_EQ(partly.flags & all_flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_OUTSIDE));
  EXPECT_EQ(view.polygons(), (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

TEST(view_positions, wrong_boxes) {
  const loaded_file file(row_of_cells());
  const test_view view(file.db());
  const float nan = std::nanf("");
  EXPECT_EQ(move_box(view, {1, 1, 1}, {2, 0.5f, 2}, SIGHTCELL_ERR_ARGUMENT).flags & SIGHTCELL_FRAME_DRAW_ALL,
            static_cast<std::uint32_t>(SIGHTCELL_FRAME_DRAW_ALL));
  static_cast<void>(move_box(view, {1, nan, 1}, {2, 2, 2}, SIGHTCELL_ERR_ARGUMENT));
  static_cast<void>(move_box(view, {1, 1, 1}, {2, 2, nan}, SIGHTCELL_ERR_ARGUMENT));
  EXPECT_EQ(view.polygons().size(), 40u);
  const float place[3] = {1, 1, 1};
  sightcell_frame frame;
  EXPECT_EQ(sightcell_view_move_box(view.get(), nullptr, place, &frame), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_move_box(view.get(), place, nullptr, &frame), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_move_box(view.get(), place, place, nullptr), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_move_box(nullptr, place, place, &frame), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(move_box(view, {1, 1, 1}, {2, 1, 2}).cell, 0u) << "and works on afterwards";
  EXPECT_EQ(move_box(view, {-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}).flags & all_flags, all_flags);
  const float inf = std::numeric_limits<float>::infinity();
  sample_contents on_lattice = random_contents(9, {.polygons = 40, .draws = 3, .cells = 100});
  put_on_lattice(on_lattice);
  const loaded_file other(on_lattice);
  for (const loaded_file* of : {&file, &other}) {
    const test_view far(of->db());
    for (const float low : {-inf, 1.0f, inf}) {
      EXPECT_EQ(move_box(far, {low, low, low}, {inf, inf, inf}).flags & SIGHTCELL_FRAME_DRAW_ALL,
                static_cast<std::uint32_t>(SIGHTCELL_FRAME_DRAW_ALL));
    }
  }
}

std::size_t ranges_in_source_order(const sample_contents& contents, const std::set<std::uint32_t>& polygons) {
  std::set<std::uint32_t> begins;
  for (const auto& d : contents.draws) begins.insert(d.first_stored);
  std::size_t ranges = 0;
  for (const std::uint32_t p : polygons) ranges += p == 0 || polygons.count(p - 1) == 0 || begins.count(p) != 0 ? 1 : 0;
  return ranges;
}

// Boxes of any size against the sets of all cells that they touch, in both layouts, for any arrangement of cells.
TEST(view_positions, boxes_over_random_files) {
  random_source random(81);
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u}) {
    sample_contents contents =
        random_contents(seed, {.polygons = 700, .draws = 30, .cells = 300, .overlapping = seed == 2});
    if (seed == 3) put_on_lattice(contents);
    if (seed == 5) put_on_grid(contents);
    if (seed == 4) put_in_groups(contents, 9);
    const loaded_file file(contents);
    const test_view view(file.db());
    std::vector<std::uint32_t> order(700);
    std::size_t count = 0;
    ASSERT_EQ(sightcell_db_order(file.db(), order.data(), order.size(), &count), SIGHTCELL_OK);
    const sightcell_info info = file.info();
    ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, 100.0f), SIGHTCELL_OK);
    int several = 0;
    int exact = 0;
    for (std::size_t round = 0; round < 2000; round += case_step()) {
      const box& near = contents.cells[random() % contents.cells.size()];
      std::array<float, 3> min = near.min;
      std::array<float, 3> max;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        min[axis] += static_cast<float>(random() % 100) / 50.0f;
        max[axis] = min[axis] + static_cast<float>(random() % 100) / 40.0f;
      }
      const sightcell_frame frame = move_box(view, min, max);
      if ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0) continue;
      std::set<std::uint32_t> expected;
      int cells = 0;
      for (std::uint32_t i = 0; i < contents.cells.size(); ++i) {
        bool touched = true;
        bool kept = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const box& b = contents.cells[i];
          touched = touched && b.min[axis] <= max[axis] && min[axis] < b.max[axis];
          kept = kept && b.min[axis] - contents.facts.margin <= min[axis] &&
                 max[axis] < b.max[axis] + contents.facts.margin;
        }
        if (kept && i == frame.cell) {  // one grown box contains all of it
          expected.clear();
          expected.insert(contents.sets[i].begin(), contents.sets[i].end());
          cells = 1;
          break;
        }
        if (!touched) continue;
        expected.insert(contents.sets[i].begin(), contents.sets[i].end());
        ++cells;
      }
      const auto ranges = view.ranges();
      ASSERT_LE(ranges.size(), info.range_bound);
      auto seen = view.polygons();
      ASSERT_EQ(seen.size(), frame.polygon_count);
      std::sort(seen.begin(), seen.end());
      if (cells == 0) continue;  // the nearest cell's
      ASSERT_TRUE(std::includes(seen.begin(), seen.end(), expected.begin(), expected.end()));
      // Two sets within the bounds are united as they are.
      if (cells <= 2 && seed != 4 && ranges_in_source_order(contents, expected) <= info.range_bound) {
        ASSERT_EQ(seen.size(), expected.size());
        ++exact;
      }
      several += cells > 1 ? 1 : 0;
    }
    const int least = 100 / static_cast<int>(case_step());
    EXPECT_GT(several, least);
    EXPECT_TRUE(exact > least || seed == 4);
  }
}

TEST(view_positions, a_union_with_more_ranges_than_promised_closes_the_smallest_gaps) {
  sample_contents contents;
  contents.facts.polygon_count = 100;
  contents.facts.margin = 0.25f;
  contents.draws = {{.polygon_count = 100}};
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  contents.sets = {{0, 50}, {3, 90}};
  const loaded_file file(contents);
  const sightcell_info info = file.info();
  ASSERT_EQ(info.range_bound, 2u);
  const test_view view(file.db());
  static_cast<void>(move_box(view, {0.5f, 0.5f, 0.5f}, {1.5f, 0.5f, 0.5f}));
  const auto ranges = view.ranges();
  ASSERT_LE(ranges.size(), 2u);
  const auto seen = view.polygons();
  for (const std::uint32_t p : {0u, 3u, 50u, 90u}) EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), p)) << p;
  EXPECT_LT(seen.size(), 100u);
}

TEST(view_positions, gaps_between_draws_are_never_closed) {
  sample_contents contents;
  contents.facts.polygon_count = 20;
  contents.facts.margin = 0.25f;
  contents.draws = {{.polygon_count = 10}, {.first_source = 10, .polygon_count = 10, .first_stored = 10}};
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  contents.sets = {{0, 8}, {11, 19}};
  const loaded_file file(contents);
  const test_view view(file.db());
  static_cast<void>(move_box(view, {0.5f, 0.5f, 0.5f}, {1.5f, 0.5f, 0.5f}));
  EXPECT_EQ(view.polygons(),
            (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 15, 16, 17, 18, 19}));
}

// Few runs, but most of them extend from one draw into the next.
TEST(view_positions, ranges_are_counted_too) {
  sample_contents contents;
  contents.facts.polygon_count = 40;
  contents.facts.margin = 0.25f;
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  contents.sets.resize(2);
  for (std::uint32_t d = 0; d < 10; ++d) {
    contents.draws.push_back({.first_source = 4 * d, .polygon_count = 4, .first_stored = 4 * d});
    if (d < 9) {
      auto& set = contents.sets[d < 5 ? 0 : 1];
      set.insert(set.end(), {4 * d, 4 * d + 3});
    }
  }
  const loaded_file file(contents);
  ASSERT_EQ(file.info().range_bound, 10u);
  const test_view view(file.db());
  const sightcell_frame frame = move_box(view, {0.5f, 0.5f, 0.5f}, {1.5f, 0.5f, 0.5f});
  EXPECT_EQ(frame.flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
  EXPECT_LE(view.ranges().size(), 10u);
  EXPECT_EQ(view.polygons().size(), 36u);
}

TEST(view_positions, a_box_over_too_many_cells) {
  const sample_contents contents = random_contents(5, {.polygons = 50, .draws = 3, .cells = 512});
  const loaded_file file(contents);
  const test_view view(file.db());
  EXPECT_EQ(move_box(view, {0.5f, 0.5f, 0.5f}, {7, 7, 7}).flags & all_flags,
            static_cast<std::uint32_t>(SIGHTCELL_FRAME_DRAW_ALL));
  EXPECT_EQ(view.polygons().size(), 50u);
}

TEST(view_positions, outside_with_the_nearest_cell) {
  const sample_contents contents = row_of_cells();
  const loaded_file file(contents);
  test_view view(file.db());
  EXPECT_EQ(view.move(-1, 1, 1).flags & all_flags, all_flags) << "everything by default";
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, 2.0f), SIGHTCELL_OK);
  sightcell_frame frame = view.move(-1, 1, 1);
  EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_CHANGED | SIGHTCELL_FRAME_OUTSIDE);
  EXPECT_EQ(frame.cell, SIGHTCELL_NO_CELL);
  EXPECT_EQ(view.polygons(), contents.sets[0]);
  EXPECT_EQ(view.move(-2.5f, 1, 1).flags & all_flags, all_flags) << "too far";
  frame = view.move(7, 3, 1);
  EXPECT_EQ(frame.flags & all_flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_OUTSIDE));
  EXPECT_EQ(view.polygons(), contents.sets[1]);
  EXPECT_EQ(view.move(9, 3, 1).polygon_count, 2u);
  EXPECT_EQ(view.polygons(), contents.sets[2]);
  EXPECT_EQ(view.move(9, 1, 1).flags & all_flags, 0u);
  EXPECT_EQ(view.polygons(), contents.sets[2]);
}

TEST(view_positions, the_nearest_cell_along_a_walk_outside) {
  random_source random(82);
  for (const bool lattice : {false, true}) {
    sample_contents contents = random_contents(6, {.polygons = 400, .draws = 9, .cells = 200, .overlapping = !lattice});
    if (lattice) put_on_lattice(contents);
    for (std::uint32_t i = 0; i < contents.sets.size(); ++i) contents.sets[i] = {i};  // which cell it is
    const loaded_file file(contents);
    test_view view(file.db());
    ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, std::numeric_limits<float>::infinity()),
              SIGHTCELL_OK);
    std::array<float, 3> eye{20, 5, 3};
    int outside = 0;
    for (int step = 0; step < 20000; ++step) {
      for (float& e : eye) e += (static_cast<float>(random() % 1001) - 500.0f) * (step % 100 == 0 ? 0.02f : 0.0004f);
      for (float& e : eye) e = std::clamp(e, -60.0f, 60.0f);
      const sightcell_frame frame = view.move(eye[0], eye[1], eye[2]);
      ASSERT_EQ(frame.flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
      if ((frame.flags & SIGHTCELL_FRAME_OUTSIDE) == 0) continue;
      ++outside;
      const auto distance = [&](const box& b) {
        double sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto p = static_cast<double>(eye[axis]);
          const double away =
              std::max({static_cast<double>(b.min[axis]) - p, p - static_cast<double>(b.max[axis]), 0.0});
          sum += away * away;
        }
        return std::sqrt(sum);
      };
      double least = 1e30;
      for (const box& b : contents.cells) least = std::min(least, distance(b));
      ASSERT_NEAR(distance(contents.cells[view.polygons().at(0)]), least, 1e-9) << "step " << step;
    }
    EXPECT_GT(outside, 5000);
  }
}

TEST(view_positions, outside_with_the_last_cell) {
  const sample_contents contents = row_of_cells();
  const loaded_file file(contents);
  test_view view(file.db());
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_LAST, 3.0f), SIGHTCELL_OK);
  EXPECT_EQ(view.move(1, 5, 1).flags & all_flags, all_flags) << "there was none yet";
  EXPECT_EQ(view.move(5, 1, 1).cell, 1u);
  const sightcell_frame frame = view.move(5, 4, 1);
  EXPECT_EQ(frame.flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_OUTSIDE)) << "nothing changes";
  EXPECT_EQ(frame.cell, SIGHTCELL_NO_CELL);
  EXPECT_EQ(view.polygons(), contents.sets[1]);
  EXPECT_EQ(view.move(2.5f, 4, 1).flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_OUTSIDE))
      << "though others are nearer";
  EXPECT_EQ(view.move(5, 5.5f, 1).flags & all_flags, all_flags);
  EXPECT_EQ(view.move(5, 4.5f, 1).flags & all_flags, static_cast<std::uint32_t>(SIGHTCELL_FRAME_OUTSIDE));
  EXPECT_EQ(view.polygons(), contents.sets[1]);
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_ALL, 0.0f), SIGHTCELL_OK);
  EXPECT_EQ(view.move(5, 4.5f, 1).flags & all_flags, all_flags);
}

TEST(view_positions, wrong_policies_and_origins) {
  const loaded_file file(row_of_cells());
  const test_view view(file.db());
  EXPECT_EQ(sightcell_view_policy(view.get(), 3, 1.0f), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_PENDING_LAST + 3, 1.0f), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_LAST, -1.0f), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_LAST, std::nanf("")), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_policy(nullptr, SIGHTCELL_OUTSIDE_LAST, 1.0f), SIGHTCELL_ERR_ARGUMENT);
  const double nowhere[3] = {0, std::numeric_limits<double>::infinity(), 0};
  EXPECT_EQ(sightcell_view_origin(view.get(), nowhere), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_origin(view.get(), nullptr), SIGHTCELL_ERR_ARGUMENT);
  const double origin[3] = {};
  EXPECT_EQ(sightcell_view_origin(nullptr, origin), SIGHTCELL_ERR_ARGUMENT);
}

// A level 100 km from the origin of its file. Floats there are 8 mm apart, so that an eye in world space would jump
// between them; an eye relative to an origin of its own does not.
TEST(view_positions, a_hundred_kilometers_from_the_origin) {
  sample_contents contents;
  add_draws(contents, 400, 4);
  contents.facts.margin = 0.25f;
  contents.lattice = sightcell::format::lattice_shape{0.5, 2.0};
  for (int x = 0; x < 8; ++x) contents.places.push_back({200'000 + x, 0, -200'000, 0});
  for (std::uint32_t i = 0; i < 8; ++i) {
    contents.cells.push_back(sightcell::format::box_of(*contents.lattice, contents.places[i]));
    contents.sets.push_back({i});
  }
  const loaded_file file(contents);
  test_view view(file.db());
  const double origin[3] = {100'000.0, 0.0, -100'000.0};
  ASSERT_EQ(sightcell_view_origin(view.get(), origin), SIGHTCELL_OK);
  // In steps of a millimeter, each in the cell that contains it or in the grown box of the one before.
  for (int step = 0; step < 3990; ++step) {
    const double x = step * 0.001;
    const sightcell_frame frame = view.move(static_cast<float>(x), 1.0f, 0.25f);
    ASSERT_LT(frame.cell, 8u) << x;
    const double begin = frame.cell * 0.5;
    ASSERT_GE(x, begin - 0.2501);
    ASSERT_LT(x, begin + 0.7501);
  }
  EXPECT_EQ(view.move(0.6f, 1.0f, 0.25f).cell, 1u);
  const float min[3] = {0.4f, 1.0f, 0.25f};
  const float max[3] = {1.3f, 1.0f, 0.25f};
  sightcell_frame frame;
  ASSERT_EQ(sightcell_view_move_box(view.get(), min, max, &frame), SIGHTCELL_OK);
  EXPECT_EQ(view.polygons(), (std::vector<std::uint32_t>{0, 1, 2}));
  const double home[3] = {};
  ASSERT_EQ(sightcell_view_origin(view.get(), home), SIGHTCELL_OK);
  EXPECT_EQ(view.move(0.6f, 1.0f, 0.25f).flags & all_flags, all_flags);
}

// Grown boxes end at their exact borders there, not at the next float.
TEST(view_positions, grown_boxes_a_hundred_kilometers_from_the_origin) {
  sample_contents contents = tiny_contents();
  contents.facts.margin = 0.1f;
  for (auto& b : contents.cells) b.min[0] += 100'000.0f, b.max[0] += 100'000.0f;
  const loaded_file file(contents);
  test_view view(file.db());
  const double origin[3] = {100'000.0, 0.0, 0.0};
  ASSERT_EQ(sightcell_view_origin(view.get(), origin), SIGHTCELL_OK);
  for (const float beyond : {-0.0005f, 0.0005f}) {
    EXPECT_EQ(view.move(1, 1, 1).cell, 0u);
    EXPECT_EQ(view.move(-0.1f - beyond, 1, 1).cell, beyond > 0.0f ? SIGHTCELL_NO_CELL : 0u);
    EXPECT_EQ(view.move(7, 1, 1).cell, 1u);
    EXPECT_EQ(view.move(8.1f + beyond, 1, 1).cell, beyond > 0.0f ? SIGHTCELL_NO_CELL : 1u);
  }
}

TEST(view_positions, several_files_at_once) {
  const sample_contents first = row_of_cells();
  sample_contents second = row_of_cells();
  std::reverse(second.sets.begin(), second.sets.end());
  const loaded_file a(first);
  const loaded_file b(second);
  test_view from_a(a.db());
  test_view from_b(b.db());
  for (std::uint32_t i = 0; i < 4; ++i) {
    const float x = 4.0f * static_cast<float>(i) + 2.0f;
    static_cast<void>(from_a.move(x, 1, 1));
    static_cast<void>(from_b.move(x, 1, 1));
    EXPECT_EQ(from_a.polygons(), first.sets[i]);
    EXPECT_EQ(from_b.polygons(), second.sets[i]);
  }
}

}  // namespace
