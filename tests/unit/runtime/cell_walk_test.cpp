// The cell contract of sightcell_view_move over long random walks, against an oracle that tries every box.
#include <gtest/gtest.h>

#include <cmath>

#include "golden/golden_contents.h"
#include "loaded_file.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;
using sightcell::format::box;

class oracle {
 public:
  explicit oracle(const sample_contents& contents) : contents_(contents) {}

  std::uint32_t move(const float eye[3]) {
    std::uint32_t best = SIGHTCELL_NO_CELL;
    for (std::uint32_t i = 0; i < contents_.cells.size(); ++i) {
      if (holds(contents_.cells[i], 0.0, eye) && (best == SIGHTCELL_NO_CELL || volume(i) < volume(best))) best = i;
    }
    const bool keep = cell_ != SIGHTCELL_NO_CELL &&
                      holds(contents_.cells[cell_], static_cast<double>(contents_.facts.margin), eye) &&
                      (best == SIGHTCELL_NO_CELL || volume(best) >= volume(cell_));
    if (!keep) cell_ = best;
    return cell_;
  }

 private:
  static bool holds(const box& b, double margin, const float eye[3]) {
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<double>(eye[axis]);
      inside = inside && place >= static_cast<double>(b.min[axis]) - margin &&
               place < static_cast<double>(b.max[axis]) + margin;
    }
    return inside;
  }
  [[nodiscard]] double volume(std::uint32_t cell) const {
    const box& b = contents_.cells[cell];
    double v = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      v *= static_cast<double>(b.max[axis]) - static_cast<double>(b.min[axis]);
    }
    return v;
  }

  const sample_contents& contents_;
  std::uint32_t cell_ = SIGHTCELL_NO_CELL;
};

// A coordinate on, or a float next to, a border of a box or of a grown box.
float border_place(const sample_contents& contents, random_source& random, std::size_t axis) {
  const box& b = contents.cells[random() % contents.cells.size()];
  float place = random() % 2 == 0 ? b.min[axis] : b.max[axis];
  const std::uint32_t kind = random() % 3;
  if (kind == 1) place -= contents.facts.margin;
  if (kind == 2) place += contents.facts.margin;
  const std::uint32_t side = random() % 3;
  return side == 0 ? place : std::nextafter(place, side == 1 ? -1000.0f : 1000.0f);
}

void walk(const sample_contents& contents, std::uint32_t seed, int steps) {
  random_source random(seed);
  const loaded_file file(contents);
  test_view view(file.db());
  oracle expected(contents);
  float eye[3] = {1, 1, 1};
  int kept_outside = 0;
  int cells_seen = 0;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float small = (static_cast<float>(random() % 1001) / 1000.0f - 0.5f) * 0.3f;
      const std::uint32_t kind = random() % 40;
      if (kind == 0) {
        eye[axis] = static_cast<float>(random() % 1400) / 100.0f - 1.0f;  // a jump
      } else if (kind < 8) {
        eye[axis] = border_place(contents, random, axis);
      } else {
        eye[axis] += small;
      }
    }
    const std::uint32_t cell = expected.move(eye);
    const sightcell_frame frame = view.move(eye[0], eye[1], eye[2]);
    ASSERT_EQ(frame.cell, cell) << "step " << step << " at " << eye[0] << " " << eye[1] << " " << eye[2];
    ASSERT_EQ((frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0, cell == SIGHTCELL_NO_CELL);
    ASSERT_EQ((frame.flags & SIGHTCELL_FRAME_OUTSIDE) != 0, cell == SIGHTCELL_NO_CELL);
    if (cell == SIGHTCELL_NO_CELL) continue;
    ++cells_seen;
    ASSERT_EQ(frame.polygon_count, contents.sets[cell].size());
    const box& b = contents.cells[cell];
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) inside = inside && eye[axis] >= b.min[axis] && eye[axis] < b.max[axis];
    kept_outside += inside ? 0 : 1;
  }
  EXPECT_GT(cells_seen, steps / 10) << "the walk must be inside cells";
  EXPECT_GT(kept_outside, steps / 1000) << "and in grown boxes";
}

TEST(cell_walk, grid) {
  walk(random_contents(1, {.polygons = 60, .cells = 512}), 1, 40000);
}

TEST(cell_walk, overlapping_boxes) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    walk(random_contents(seed, {.polygons = 60, .cells = 60, .overlapping = true}), seed, 20000);
  }
}

// Slowly, as a camera walks, so that most moves need no search for cells: among few small cells, and among more than
// the view tests.
TEST(cell_walk, slowly_among_small_boxes) {
  for (const std::uint32_t small : {40u, 400u}) {
    random_source random(small);
    sample_contents contents;
    add_draws(contents, 10, 1);
    contents.facts.margin = 0.25f;
    contents.cells = {{{0, 0, 0}, {8, 8, 8}}, {{2, 1, 3}, {7, 6, 9}}};
    const auto some = [&](float from, float size) { return from + size * static_cast<float>(random.share()); };
    for (std::uint32_t i = 0; i < small; ++i) {
      box b;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        b.min[axis] = some(2, 4);
        b.max[axis] = b.min[axis] + some(0.1f, 0.6f);
      }
      contents.cells.push_back(b);
    }
    contents.sets.resize(contents.cells.size(), {1});
    const loaded_file file(contents);
    test_view view(file.db());
    oracle expected(contents);
    float eye[3] = {4, 4, 4};
    int in_small = 0;
    int in_large = 0;
    for (int step = 0; step < 30000; ++step) {
      for (float& place : eye) {
        place += some(-0.03f, 0.06f);
        if (step % 500 == 0) place = some(2.5f, 3);
      }
      const std::uint32_t cell = expected.move(eye);
      ASSERT_EQ(view.move(eye[0], eye[1], eye[2]).cell, cell) << step;
      (cell < 2 ? in_large : in_small) += 1;
    }
    EXPECT_GT(in_small, 300);
    EXPECT_GT(in_large, 300);
  }
}

// Several widths and heights: most cells meet at their sides, and some contain others. The smallest wins.
TEST(cell_walk, boxes_on_a_grid) {
  walk(grid_contents(), 4, 40000);
}

TEST(cell_walk, one_box_inside_another) {
  sample_contents contents;
  add_draws(contents, 10, 1);
  contents.facts.margin = 0.5f;
  contents.cells = {{{0, 0, 0}, {4, 4, 4}}, {{1, 1, 1}, {2, 2, 2}}};
  contents.sets = {{1}, {2}};
  const loaded_file file(contents);
  test_view view(file.db());
  EXPECT_EQ(view.move(3, 3, 3).cell, 0u);
  EXPECT_EQ(view.move(1.5f, 1.5f, 1.5f).cell, 1u) << "the smaller box wins at once";
  EXPECT_EQ(view.move(2.25f, 1.5f, 1.5f).cell, 1u) << "and is kept in its grown box";
  EXPECT_EQ(view.move(2.75f, 1.5f, 1.5f).cell, 0u);
  EXPECT_EQ(view.move(4.25f, 1.5f, 1.5f).cell, 0u) << "kept outside all boxes";
  EXPECT_EQ(view.move(4.75f, 1.5f, 1.5f).cell, SIGHTCELL_NO_CELL);
  EXPECT_EQ(view.move(4.25f, 1.5f, 1.5f).cell, SIGHTCELL_NO_CELL) << "once left, the grown box does not count";
}

TEST(cell_walk, a_jump_inside_the_grown_box_keeps_the_cell) {
  sample_contents contents;
  add_draws(contents, 10, 1);
  contents.facts.margin = 0.5f;
  contents.cells = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{0, 1, 0}, {1, 1.5f, 1}}};
  contents.sets = {{1}, {2}, {3}};
  const loaded_file file(contents);
  test_view view(file.db());
  EXPECT_EQ(view.move(0.5f, 0.5f, 0.5f).cell, 0u);
  EXPECT_EQ(view.move(1.25f, 0.5f, 0.5f).cell, 0u) << "a neighbor of the same size";
  EXPECT_EQ(view.move(0.5f, 1.25f, 0.5f).cell, 2u) << "a smaller neighbor";
}

}  // namespace
