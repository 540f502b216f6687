// Visibility of boxes through a view: which volumes a cell sees, for every kind of move.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "loaded_file.h"
#include "paged_host.h"
#include "sightcell/format/layout.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;
using sightcell::format::box;

using corner = std::array<float, 3>;

bool visible(const sightcell_view* view, const corner& min, const corner& max) {
  std::uint32_t seen = 7;
  EXPECT_EQ(sightcell_view_box_visible(view, min.data(), max.data(), &seen), SIGHTCELL_OK);
  EXPECT_LE(seen, 1u);
  return seen != 0;
}

std::vector<box> volumes_of(const sightcell_db* db) {
  std::vector<box> boxes(sightcell_db_volume_count(db));
  for (std::uint32_t v = 0; v < boxes.size(); ++v) {
    EXPECT_EQ(sightcell_db_volume_box(db, v, boxes[v].min.data(), boxes[v].max.data()), SIGHTCELL_OK);
  }
  return boxes;
}

// Touches no other position.
corner middle_of(const box& b) {
  return {(b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2};
}

// Whether two closed boxes intersect.
bool meet(const box& b, const corner& min, const corner& max) {
  bool meets = true;
  for (std::size_t axis = 0; axis < 3; ++axis) meets = meets && b.min[axis] <= max[axis] && min[axis] <= b.max[axis];
  return meets;
}

// Positions of the volumes' lattice that a closed box touches, on its border too.
std::size_t places_touched(const box& volume, const corner& min, const corner& max) {
  std::size_t places = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = static_cast<double>(volume.max[axis]) - static_cast<double>(volume.min[axis]);
    const auto border = [&](int place) { return static_cast<float>(place * size); };
    std::size_t on_axis = 0;
    const int from = static_cast<int>(std::floor(static_cast<double>(min[axis]) / size)) - 2;
    const int to = static_cast<int>(std::floor(static_cast<double>(max[axis]) / size)) + 2;
    for (int place = from; place <= to; ++place) {
      on_axis += border(place) <= max[axis] && min[axis] <= border(place + 1) ? 1 : 0;
    }
    places *= on_axis;
  }
  return places;
}

// The result by the sets: visible if the box touches a volume of one of the cells, or a position that is no volume.
bool expected(const sample_contents& contents, const std::vector<box>& volumes, const std::vector<std::uint32_t>& cells,
              const corner& min, const corner& max) {
  std::vector<bool> seen(volumes.size());
  for (const std::uint32_t cell : cells) {
    for (const std::uint32_t item : contents.sets[cell]) {
      if (item >= contents.facts.polygon_count) seen[item - contents.facts.polygon_count] = true;
    }
  }
  std::size_t touched = 0;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    if (!meet(volumes[v], min, max)) continue;
    if (seen[v]) return true;
    ++touched;
  }
  return touched < places_touched(volumes[0], min, max);
}

// A box within four volumes on each axis.
void some_box(random_source& random, const std::vector<box>& volumes, corner& min, corner& max) {
  const box& near = volumes[random() % volumes.size()];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float size = near.max[axis] - near.min[axis];
    min[axis] = near.min[axis] + size * (static_cast<float>(random() % 101) / 50.0f - 0.5f);
    max[axis] = min[axis] + size * static_cast<float>(random() % 101) / 80.0f;
    if (random() % 5 == 0) max[axis] = near.max[axis];
    if (max[axis] < min[axis]) std::swap(min[axis], max[axis]);
  }
}

sample_contents with_volumes(std::uint32_t seed) {
  sample_contents contents = random_contents(seed, {.polygons = 300, .draws = 9, .cells = 200});
  add_volumes(contents, 400, seed);
  return contents;
}

TEST(box_visible, as_in_the_sets) {
  const sample_contents contents = with_volumes(41);
  const loaded_file file(contents);
  test_view view(file.db());
  const auto volumes = volumes_of(file.db());
  ASSERT_EQ(volumes.size(), 400u);
  random_source random(42);
  int hidden = 0;
  int seen = 0;
  for (std::uint32_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& b = contents.cells[cell];
    const auto frame = view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2);
    ASSERT_EQ(frame.cell, cell);
    std::vector<std::uint32_t> polygons = contents.sets[cell];
    std::erase_if(polygons, [](std::uint32_t item) { return item >= 300; });
    ASSERT_EQ(view.polygons(), polygons) << "volumes are not polygons";
    for (int round = 0; round < 60; ++round) {
      corner min, max;
      some_box(random, volumes, min, max);
      const bool answer = visible(view.get(), min, max);
      ASSERT_EQ(answer, expected(contents, volumes, {cell}, min, max)) << "cell " << cell;
      hidden += answer ? 0 : 1;
      seen += answer ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 200);
  EXPECT_GT(seen, 200);
}

TEST(box_visible, from_a_box_what_any_of_its_cells_sees) {
  const sample_contents contents = with_volumes(43);
  const loaded_file file(contents);
  const test_view view(file.db());
  ASSERT_EQ(sightcell_view_policy(view.get(), SIGHTCELL_OUTSIDE_NEAREST, 100.0f), SIGHTCELL_OK);
  const auto volumes = volumes_of(file.db());
  random_source random(44);
  int checked = 0;
  for (int round = 0; round < 300; ++round) {
    const box& first = contents.cells[random() % contents.cells.size()];
    const corner from{first.min[0] + 0.4f, first.min[1] + 0.4f, first.min[2] + 0.4f};
    const corner to{from[0] + 1.0f, from[1] + 0.1f, from[2] + 0.1f};
    sightcell_frame frame;
    ASSERT_EQ(sightcell_view_move_box(view.get(), from.data(), to.data(), &frame), SIGHTCELL_OK);
    std::vector<std::uint32_t> cells;
    for (std::uint32_t i = 0; i < contents.cells.size(); ++i) {
      const box& b = contents.cells[i];
      bool touched = true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        touched = touched && b.min[axis] <= to[axis] && from[axis] < b.max[axis];
      if (touched) cells.push_back(i);
    }
    if (cells.size() < 2) continue;
    corner min, max;
    some_box(random, volumes, min, max);
    ASSERT_EQ(visible(view.get(), min, max), expected(contents, volumes, cells, min, max));
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(box_visible, from_two_cells_what_either_sees) {
  sample_contents contents = with_volumes(50);
  contents.sets.assign(contents.sets.size(), {1, 2});
  contents.sets[0] = {1, 2, 300};  // at 0.5 0.5 0.5
  contents.sets[1] = {1, 2, 301};  // at 1.5 0.5 0.5
  const loaded_file file(contents);
  const test_view view(file.db());
  const auto volumes = volumes_of(file.db());
  const corner from{0.5f, 0.5f, 0.5f};
  const corner to{1.5f, 0.5f, 0.5f};
  sightcell_frame frame;
  ASSERT_EQ(sightcell_view_move_box(view.get(), from.data(), to.data(), &frame), SIGHTCELL_OK);
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    ASSERT_EQ(visible(view.get(), middle_of(volumes[v]), middle_of(volumes[v])), v < 2) << v;
  }
}

TEST(box_visible, changes_though_the_polygons_do_not) {
  sample_contents contents = with_volumes(45);
  contents.sets.assign(contents.sets.size(), {1, 2});
  contents.sets[1] = {1, 2, 300};
  const loaded_file file(contents);
  test_view view(file.db());
  const box seen = volumes_of(file.db())[0];
  const auto move_into = [&](std::uint32_t cell) {
    const auto& b = contents.cells[cell];
    return view.move((b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2);
  };
  const corner middle = middle_of(seen);
  static_cast<void>(move_into(0));
  EXPECT_FALSE(visible(view.get(), middle, middle));
  EXPECT_EQ(move_into(1).flags, 0u) << "the same polygons";
  EXPECT_TRUE(visible(view.get(), middle, middle));
  static_cast<void>(move_into(2));
  EXPECT_FALSE(visible(view.get(), middle, middle));
  const double origin[3] = {1000.0, 0.0, 0.0};
  ASSERT_EQ(sightcell_view_origin(view.get(), origin), SIGHTCELL_OK);
  EXPECT_TRUE(visible(view.get(), middle, middle)) << "no volumes there";
  EXPECT_FALSE(
      visible(view.get(), {middle[0] - 1000.0f, middle[1], middle[2]}, {middle[0] - 1000.0f, middle[1], middle[2]}));
}

TEST(box_visible, fails_open) {
  const sample_contents contents = with_volumes(46);
  const loaded_file file(contents);
  test_view view(file.db());
  const corner far{1e6f, 0, 0};
  EXPECT_TRUE(visible(view.get(), far, far)) << "beyond all volumes";
  static_cast<void>(view.move(-1e5f, 0, 0));
  for (const box& v : volumes_of(file.db())) {
    ASSERT_TRUE(visible(view.get(), middle_of(v), middle_of(v))) << "under DRAW_ALL";
  }
  const float nan = std::nanf("");
  const float low[3] = {0, 0, 0};
  const float wrong[3] = {1, nan, 1};
  const float below[3] = {-1, 1, 1};
  for (const auto& [min, max] : {std::pair(low, wrong), std::pair(wrong, low), std::pair(low, below)}) {
    std::uint32_t seen = 0;
    EXPECT_EQ(sightcell_view_box_visible(view.get(), min, max, &seen), SIGHTCELL_ERR_ARGUMENT);
    EXPECT_EQ(seen, 1u);
  }
  std::uint32_t seen = 0;
  EXPECT_EQ(sightcell_view_box_visible(nullptr, low, low, &seen), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(seen, 1u);
  EXPECT_EQ(sightcell_view_box_visible(view.get(), low, low, nullptr), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_box_visible(view.get(), nullptr, low, &seen), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_view_box_visible(view.get(), low, nullptr, &seen), SIGHTCELL_ERR_ARGUMENT);
  float a[3], b[3];
  EXPECT_EQ(sightcell_db_volume_box(file.db(), 400, a, b), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_volume_box(nullptr, 0, a, b), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_volume_box(file.db(), 0, nullptr, b), SIGHTCELL_ERR_ARGUMENT);
  EXPECT_EQ(sightcell_db_volume_count(nullptr), 0u);
}

TEST(box_visible, fails_open_where_rows_are_damaged) {
  auto bytes = with_volumes(46).encode();
  bytes[section_offset(bytes, sightcell::format::layout::section_rows)] ^= std::byte{1};
  const loaded_file file(std::move(bytes));
  test_view view(file.db());
  ASSERT_NE(view.move(0.5f, 0.5f, 0.5f).flags & SIGHTCELL_FRAME_DAMAGED, 0u);
  for (const box& v : volumes_of(file.db())) ASSERT_TRUE(visible(view.get(), middle_of(v), middle_of(v)));
}

TEST(box_visible, without_volumes_everything_is) {
  const sample_contents contents = random_contents(47, {.polygons = 300, .draws = 9, .cells = 20});
  const loaded_file file(contents);
  test_view view(file.db());
  static_cast<void>(view.move(0.5f, 0.5f, 0.5f));
  EXPECT_EQ(sightcell_db_volume_count(file.db()), 0u);
  EXPECT_TRUE(visible(view.get(), {0, 0, 0}, {1, 1, 1}));
}

TEST(box_visible, of_a_paged_file) {
  const sample_contents contents = with_volumes(48);
  paged_host host(contents.encode());
  ASSERT_EQ(host.open(1 << 20), SIGHTCELL_OK);
  test_view paged(host.db());
  const loaded_file file(contents);
  test_view whole(file.db());
  const auto volumes = volumes_of(host.db());
  random_source random(49);
  for (int round = 0; round < 400; ++round) {
    const auto& b = contents.cells[random() % contents.cells.size()];
    const corner eye{(b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, (b.min[2] + b.max[2]) / 2};
    const bool pending = (paged.move(eye[0], eye[1], eye[2]).flags & SIGHTCELL_FRAME_PENDING) != 0;
    static_cast<void>(whole.move(eye[0], eye[1], eye[2]));
    corner min, max;
    some_box(random, volumes, min, max);
    ASSERT_EQ(visible(paged.get(), min, max), pending || visible(whole.get(), min, max));
    host.deliver_all();
  }
}

}  // namespace
