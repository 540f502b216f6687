// The results of a view after a move: sets, ranges, indices, changes, fail open.
#include "view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "loaded_file.h"
#include "sightcell/format/layout.h"

namespace {

using namespace sightcell::test;

constexpr std::uint32_t changed = SIGHTCELL_FRAME_CHANGED;

std::vector<std::uint32_t> stored_indices(std::uint32_t polygons) {
  std::vector<std::uint32_t> indices(std::size_t{3} * polygons);
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i * 7 + 1);
  return indices;
}

// All outputs return the same set.
void expect_set(const test_view& view, const sample_contents& contents, const std::vector<std::uint32_t>& set) {
  EXPECT_EQ(view.polygons(), set);
  EXPECT_EQ(polygons_of(view.ranges(), contents), set);
  const auto stored = stored_indices(contents.facts.polygon_count);
  std::vector<std::uint32_t> expected;
  for (const std::uint32_t p : set) {
    for (std::size_t corner = 0; corner < 3; ++corner) expected.push_back(stored[3 * std::size_t{p} + corner]);
  }
  EXPECT_EQ(view.indices(stored), expected);
}

// Moves to the center of cell n of the grid of sample contents.
sightcell_frame go_to(test_view& view, const sample_contents& contents, std::uint32_t cell) {
  const auto& b = contents.cells[cell];
  return view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2);
}

TEST(view, sees_nothing_before_the_first_move) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  const test_view view(file.db());
  expect_set(view, contents, {});
  std::size_t added = 9;
  std::size_t removed = 9;
  EXPECT_EQ(sightcell_view_changes(view.get(), 0, nullptr, 0, &added, nullptr, 0, &removed), SIGHTCELL_OK);
  EXPECT_EQ(added + removed, 0u);
  EXPECT_EQ(sightcell_view_changes(view.get(), 0xFFFFFFFFu, nullptr, 0, &added, nullptr, 0, &removed),
            SIGHTCELL_ERR_STALE);
}

TEST(view, every_cell_shows_its_set) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const sample_contents contents = random_contents(seed, {.polygons = 900, .draws = 30, .cells = 200});
    const loaded_file file(contents);
    test_view view(file.db());
    sightcell_info info{};
    info.struct_size = sizeof(info);
    ASSERT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_OK);
    for (std::uint32_t i = 0; i < 200; ++i) {
      const std::uint32_t cell = i * 77 % 200;
      const sightcell_frame frame = go_to(view, contents, cell);
      ASSERT_EQ(frame.cell, cell);
      EXPECT_EQ(frame.flags & ~changed, 0u);
      EXPECT_EQ(frame.polygon_count, contents.sets[cell].size());
      EXPECT_LE(view.ranges().size(), info.range_bound);
      expect_set(view, contents, contents.sets[cell]);
    }
  }
}

// Polygons are source ids in stored order, and db_order returns the same order.
void expect_sets_in_stored_order(const sample_contents& contents) {
  const loaded_file file(contents);
  EXPECT_EQ(sightcell_db_check(file.db()), SIGHTCELL_OK);
  std::vector<std::uint32_t> order(900);
  std::size_t count = 0;
  ASSERT_EQ(sightcell_db_order(file.db(), order.data(), order.size(), &count), SIGHTCELL_OK);
  EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
  test_view view(file.db());
  for (std::uint32_t cell = 0; cell < 100; ++cell) {
    ASSERT_EQ(go_to(view, contents, cell).cell, cell);
    std::vector<std::uint32_t> expected;
    for (const std::uint32_t stored : polygons_of(view.ranges(), contents)) expected.push_back(order[stored]);
    std::vector<std::uint32_t> seen = view.polygons();
    EXPECT_EQ(seen, expected);
    std::sort(seen.begin(), seen.end());
    EXPECT_EQ(seen, contents.sets[cell]);
  }
  // Everything, where no set is known.
  const sightcell_frame outside = view.move(1000, 1000, 1000);
  EXPECT_NE(outside.flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
  EXPECT_EQ(view.polygons(), order);
  EXPECT_EQ(polygons_of(view.ranges(), contents), all_polygons(900));
}

TEST(view, polygons_in_an_order_of_the_file) {
  sample_contents contents = random_contents(4, {.polygons = 900, .draws = 30, .cells = 100});
  put_in_order(contents, 7);
  expect_sets_in_stored_order(contents);
  put_in_groups(contents, 8);
  expect_sets_in_stored_order(contents);
}

// Sets of whole draw groups have one range for each: the borders of draws do not count.
TEST(view, ranges_of_a_merged_file_are_of_draw_groups) {
  sample_contents contents = random_contents(4, {.polygons = 900, .draws = 30, .cells = 2});
  put_in_groups(contents, 8);
  contents.sets = {{}, all_polygons(900)};
  for (const auto& d : contents.draws) {
    for (std::uint32_t i = 0; d.group == 1 && i < d.polygon_count; ++i) contents.sets[0].push_back(d.first_source + i);
  }
  const loaded_file file(contents);
  test_view view(file.db());
  go_to(view, contents, 0);
  ASSERT_EQ(view.ranges().size(), 1u);
  EXPECT_EQ(view.ranges()[0].draw, 1u);
  EXPECT_EQ(view.ranges()[0].first, 0u);
  EXPECT_EQ(view.ranges()[0].count, contents.orders[1].size());
  std::size_t filled = 0;
  for (const auto& order : contents.orders) filled += order.empty() ? 0 : 1;
  go_to(view, contents, 1);
  EXPECT_EQ(view.ranges().size(), filled);
  view.move(1000, 1000, 1000);
  EXPECT_EQ(view.ranges().size(), filled);
}

TEST(view, frames_keep_their_reserved_words_zero) {
  const loaded_file file(small_contents());
  sightcell_frame frame;
  std::memset(&frame, 0xFF, sizeof(frame));
  sightcell_view* view = nullptr;
  ASSERT_EQ(sightcell_view_create(file.db(), &view), SIGHTCELL_OK);
  const float eye[3] = {0.5f, 0.5f, 0.5f};
  ASSERT_EQ(sightcell_view_move(view, eye, &frame), SIGHTCELL_OK);
  for (const std::uint32_t word : frame.reserved) EXPECT_EQ(word, 0u);
  sightcell_view_destroy(view);
}

TEST(view, revision_rises_with_each_change_and_only_then) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  sightcell_frame frame = go_to(view, contents, 11);  // an empty set, as before the first move
  EXPECT_EQ(frame.revision, 1u);
  EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_CHANGED);
  frame = go_to(view, contents, 11);
  EXPECT_EQ(frame.revision, 1u);
  EXPECT_EQ(frame.flags, 0u);
  frame = go_to(view, contents, 19);
  EXPECT_EQ(frame.revision, 2u);
  EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_CHANGED);
  frame = go_to(view, contents, 20);  // another cell with the same set
  EXPECT_EQ(frame.cell, 20u);
  EXPECT_EQ(frame.revision, 2u);
  EXPECT_EQ(frame.flags, 0u);
  frame = view.move(1000, 0, 0);
  EXPECT_EQ(frame.revision, 3u);
  frame = view.move(2000, 0, 0);
  EXPECT_EQ(frame.revision, 3u);
  EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE);
}

TEST(view, outside_draws_everything) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  for (const float x : {-100.0f, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    const sightcell_frame frame = view.move(x, 0.5f, 0.5f);
    EXPECT_EQ(frame.cell, SIGHTCELL_NO_CELL);
    EXPECT_EQ(frame.flags & ~changed, SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE);
    EXPECT_EQ(frame.polygon_count, 300u);
    expect_set(view, contents, all_polygons(300));
  }
  EXPECT_EQ(view.ranges().size(), 2u) << "the empty draw has no range";
}

TEST(view, nan_is_a_wrong_argument_and_draws_everything) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    go_to(view, contents, 3);
    float eye[3] = {0.5f, 0.5f, 0.5f};
    eye[axis] = std::nanf("");
    const sightcell_frame frame = view.move(eye[0], eye[1], eye[2], SIGHTCELL_ERR_ARGUMENT);
    EXPECT_EQ(frame.cell, SIGHTCELL_NO_CELL);
    EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_CHANGED);
    expect_set(view, contents, all_polygons(300));
  }
  go_to(view, contents, 3);
  sightcell_frame frame;
  EXPECT_EQ(sightcell_view_move(view.get(), nullptr, &frame), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_NE(frame.flags & SIGHTCELL_FRAME_DRAW_ALL, 0u);
  go_to(view, contents, 3);
  const float eye[3] = {0.5f, 0.5f, 0.5f};
  EXPECT_EQ(sightcell_view_move(view.get(), eye, nullptr), SIGHTCELL_ERR_ARGUMENT);
  expect_set(view, contents, all_polygons(300));
  EXPECT_EQ(go_to(view, contents, 3).cell, 3u) << "and works on afterwards";
}

TEST(view, too_little_room_writes_nothing_and_returns_the_need) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  const auto stored = stored_indices(300);
  for (const bool outside : {false, true}) {
    outside ? view.move(1000, 0, 0) : go_to(view, contents, 5);
    const std::size_t polygons = view.polygons().size();
    const std::size_t ranges = view.ranges().size();
    std::vector<std::uint32_t> ids(polygons * 3, 42);
    std::vector<sightcell_range> list(ranges, {42, 42, 42});
    std::size_t count = 0;
    EXPECT_EQ(sightcell_view_polygons(view.get(), ids.data(), polygons - 1, &count), SIGHTCELL_ERR_CAPACITY);
    EXPECT_EQ(count, polygons);
    EXPECT_EQ(sightcell_view_indices(view.get(), stored.data(), ids.data(), 3 * polygons - 1, &count),
              SIGHTCELL_ERR_CAPACITY);
    EXPECT_EQ(count, 3 * polygons);
    EXPECT_EQ(sightcell_view_ranges(view.get(), list.data(), ranges - 1, &count), SIGHTCELL_ERR_CAPACITY);
    EXPECT_EQ(count, ranges);
    EXPECT_EQ(ids, std::vector<std::uint32_t>(polygons * 3, 42));
    for (const auto& r : list) EXPECT_EQ(r.draw, 42u);
    EXPECT_EQ(sightcell_view_indices(view.get(), nullptr, ids.data(), 3 * polygons, &count), SIGHTCELL_ERR_ARGUMENT);
  }
}

// Source ids of stored polygons, ascending.
std::vector<std::uint32_t> sources_of(const sightcell_db* db, std::vector<std::uint32_t> stored) {
  std::vector<std::uint32_t> order(sightcell_db_polygon_count(db));
  std::size_t count = 0;
  EXPECT_EQ(sightcell_db_order(db, order.data(), order.size(), &count), SIGHTCELL_OK);
  for (std::uint32_t& polygon : stored) polygon = order.at(polygon);
  std::sort(stored.begin(), stored.end());
  return stored;
}

// Applies changes to a set and compares.
void expect_changes(const loaded_file& file, const test_view& view, const sample_contents& contents,
                    std::uint32_t since, std::vector<std::uint32_t> before, const std::vector<std::uint32_t>& after) {
  std::size_t added = 0;
  std::size_t removed = 0;
  static_cast<void>(sightcell_view_changes(view.get(), since, nullptr, 0, &added, nullptr, 0, &removed));
  std::vector<sightcell_range> plus(added + 1, {42, 42, 42});
  std::vector<sightcell_range> minus(removed + 1, {42, 42, 42});
  if (added > 0) {
    std::size_t a = 0;
    std::size_t r = 0;
    EXPECT_EQ(sightcell_view_changes(view.get(), since, plus.data(), added - 1, &a, minus.data(), removed, &r),
              SIGHTCELL_ERR_CAPACITY);
    EXPECT_TRUE(a == added && r == removed && plus[0].draw == 42 && minus[0].draw == 42);
  }
  ASSERT_EQ(sightcell_view_changes(view.get(), since, plus.data(), added, &added, minus.data(), removed, &removed),
            SIGHTCELL_OK);
  const auto gone = sources_of(file.db(), polygons_of(std::span(minus).first(removed), contents));
  const auto come = sources_of(file.db(), polygons_of(std::span(plus).first(added), contents));
  std::vector<std::uint32_t> expected_gone;
  std::vector<std::uint32_t> expected_come;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(expected_gone));
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(expected_come));
  EXPECT_EQ(gone, expected_gone);
  EXPECT_EQ(come, expected_come);
}

void expect_changes_everywhere(const sample_contents& contents) {
  const loaded_file file(contents);
  test_view view(file.db());
  std::vector<std::uint32_t> before;
  std::uint32_t revision = 0;
  for (std::uint32_t i = 0; i < 150; ++i) {
    const std::uint32_t cell = i * 37 % 150;
    const sightcell_frame frame = go_to(view, contents, cell);
    expect_changes(file, view, contents, frame.revision, contents.sets[cell], contents.sets[cell]);
    if (frame.revision != revision) expect_changes(file, view, contents, revision, before, contents.sets[cell]);
    revision = frame.revision;
    before = contents.sets[cell];
  }
}

TEST(view, changes_lead_from_one_set_to_the_next) {
  sample_contents contents = random_contents(21, {.polygons = 900, .draws = 30, .cells = 150});
  expect_changes_everywhere(contents);
  put_in_groups(contents, 5);
  expect_changes_everywhere(contents);
}

// A cell with the same set changes the cell, not the previous set.
TEST(view, changes_outlive_a_cell_with_the_same_set) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  go_to(view, contents, 3);
  go_to(view, contents, 19);
  go_to(view, contents, 20);
  expect_changes(file, view, contents, 1, contents.sets[3], contents.sets[20]);
}

TEST(view, changes_are_stale_for_other_revisions_and_across_everything) {
  const sample_contents contents = small_contents();
  const loaded_file file(contents);
  test_view view(file.db());
  std::size_t added = 9;
  std::size_t removed = 9;
  const auto changes = [&](std::uint32_t since) {
    return sightcell_view_changes(view.get(), since, nullptr, 0, &added, nullptr, 0, &removed);
  };
  go_to(view, contents, 1);
  go_to(view, contents, 2);
  go_to(view, contents, 3);
  EXPECT_EQ(changes(1), SIGHTCELL_ERR_STALE);
  EXPECT_EQ(added + removed, 0u);
  EXPECT_EQ(changes(4), SIGHTCELL_ERR_STALE);
  EXPECT_EQ(changes(2), SIGHTCELL_ERR_CAPACITY);
  view.move(1000, 0, 0);
  EXPECT_EQ(changes(3), SIGHTCELL_ERR_STALE) << "into everything";
  EXPECT_EQ(changes(4), SIGHTCELL_OK) << "the current revision";
  go_to(view, contents, 3);
  EXPECT_EQ(changes(4), SIGHTCELL_ERR_STALE) << "out of everything";
  go_to(view, contents, 4);
  EXPECT_EQ(changes(5), SIGHTCELL_ERR_CAPACITY);
}

TEST(view, a_damaged_chunk_draws_everything_and_leaves_the_others_alone) {
  const sample_contents contents = random_contents(31, {.cells = 150});
  auto bytes = contents.encode();
  const std::size_t rows = section_offset(bytes, sightcell::format::layout::section_rows);
  const std::size_t directory = section_offset(bytes, sightcell::format::layout::section_row_directory);
  bytes[rows + get_u64(bytes, directory + 16) + 3] ^= std::byte{4};  // in chunk 1
  const loaded_file file(std::move(bytes));
  test_view view(file.db());
  for (const int round : {1, 2}) {
    for (std::uint32_t cell = 0; cell < 150; ++cell) {
      const sightcell_frame frame = go_to(view, contents, cell);
      EXPECT_EQ(frame.cell, cell) << round;
      if (cell / 64 == 1) {
        EXPECT_EQ(frame.flags & ~changed, SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED);
        expect_set(view, contents, all_polygons(contents.facts.polygon_count));
        if (cell % 8 == 0) {
          EXPECT_EQ(view.move(1000, 0, 0).flags, SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE)
              << "everything still, for another reason";
        }
      } else {
        EXPECT_EQ(frame.flags & ~changed, 0u);
        expect_set(view, contents, contents.sets[cell]);
      }
    }
  }
}

// Below the checksums: a row that is invalid costs its cell the culling; buffers that the host sized by info still fit.
TEST(view, hostile_rows_fail_open) {
  const sample_contents contents = small_contents();
  const auto whole = contents.encode();
  const std::size_t rows = section_offset(whole, sightcell::format::layout::section_rows);
  std::size_t damaged = 0;
  for (std::size_t at = rows; at < whole.size(); at += 3) {
    auto bytes = whole;
    bytes[at] ^= std::byte{0x21};
    reseal(bytes);
    const loaded_file file(std::move(bytes));
    test_view view(file.db());
    sightcell_info info{};
    info.struct_size = sizeof(info);
    ASSERT_EQ(sightcell_db_info(file.db(), &info), SIGHTCELL_OK);
    for (std::uint32_t cell = 0; cell < 67; ++cell) {
      const sightcell_frame frame = go_to(view, contents, cell);
      damaged += (frame.flags & SIGHTCELL_FRAME_DAMAGED) != 0 ? 1 : 0;
      ASSERT_EQ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0, (frame.flags & SIGHTCELL_FRAME_DAMAGED) != 0);
      std::vector<sightcell_range> ranges(info.range_bound);
      std::size_t count = 0;
      ASSERT_EQ(sightcell_view_ranges(view.get(), ranges.data(), ranges.size(), &count), SIGHTCELL_OK);
      ASSERT_EQ(polygons_of(std::span(ranges).first(count), contents).size(), frame.polygon_count);
    }
  }
  EXPECT_GT(damaged, 100u);
}

// A file that claims fewer ranges than a set has would make a host's buffer too small: that set is not shown.
TEST(view, a_set_with_more_ranges_than_promised_fails_open) {
  sample_contents contents;
  add_draws(contents, 40, 4);
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  contents.sets = {{3}, all_polygons(40)};
  auto bytes = contents.encode();
  ASSERT_EQ(get_u32(bytes, sightcell::format::layout::header_range_bound), 3u);  // one draw of four is empty
  set_u32(bytes, sightcell::format::layout::header_range_bound, 2);
  reseal(bytes);
  const loaded_file file(std::move(bytes));
  test_view view(file.db());
  EXPECT_EQ(go_to(view, contents, 0).flags, SIGHTCELL_FRAME_CHANGED);
  EXPECT_EQ(go_to(view, contents, 1).flags,
            SIGHTCELL_FRAME_CHANGED | SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED);
}

TEST(view, an_empty_file_is_outside_everywhere) {
  const sample_contents contents;
  const loaded_file file(contents);
  test_view view(file.db());
  const sightcell_frame frame = view.move(0, 0, 0);
  EXPECT_EQ(frame.flags, SIGHTCELL_FRAME_CHANGED | SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE);
  EXPECT_EQ(frame.polygon_count, 0u);
  EXPECT_TRUE(view.ranges().empty());
  std::size_t count = 9;
  EXPECT_EQ(sightcell_view_indices(view.get(), nullptr, nullptr, 0, &count), SIGHTCELL_OK);
  EXPECT_EQ(count, 0u);
}

}  // namespace
