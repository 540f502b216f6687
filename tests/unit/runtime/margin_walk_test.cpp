// A million random steps in a complete run, many of them on exact borders, edges and corners of boxes and grown boxes:
// the grown box of the chosen cell always contains the eye, and no polygon that is visible from the exact position is
// missing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "loaded_file.h"
#include "unit/case_step.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::test;
using sightcell::format::box;

constexpr std::uint32_t polygons = 256;
using polygon_bits = std::bitset<polygons>;

struct region {
  std::array<double, 3> min, max;  // both ends belong to it
};

// Polygon p is visible from every position in region p and from no other. So the polygons that a camera sees are known
// exactly, and the set of a cell is that of its grown box.
class known_world {
 public:
  known_world(sample_contents& contents, std::uint32_t seed) {
    random_source random(seed);
    std::array<double, 3> low{1e30, 1e30, 1e30};
    std::array<double, 3> high{-1e30, -1e30, -1e30};
    for (const box& b : contents.cells) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], static_cast<double>(b.min[axis]));
        high[axis] = std::max(high[axis], static_cast<double>(b.max[axis]));
      }
    }
    for (region& r : regions_) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double size = high[axis] - low[axis];
        r.min[axis] = low[axis] + size * (random() % 1000) / 1000.0;
        r.max[axis] = r.min[axis] + size * (random() % 300) / 1000.0;
        // Some end where boxes and grown boxes do.
        const box& b = contents.cells[random() % contents.cells.size()];
        const double grow = (random() % 3 - 1.0) * static_cast<double>(contents.facts.margin);
        if (random() % 4 == 0) r.max[axis] = std::max(r.min[axis], static_cast<double>(b.min[axis]) - grow);
        if (random() % 4 == 0) r.min[axis] = std::min(r.max[axis], static_cast<double>(b.max[axis]) + grow);
      }
    }
    contents.sets.assign(contents.cells.size(), {});
    const auto margin = static_cast<double>(contents.facts.margin);
    for (std::size_t cell = 0; cell < contents.cells.size(); ++cell) {
      const box& b = contents.cells[cell];
      for (std::uint32_t p = 0; p < polygons; ++p) {
        bool seen = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          seen = seen && regions_[p].min[axis] < static_cast<double>(b.max[axis]) + margin &&
                 regions_[p].max[axis] >= static_cast<double>(b.min[axis]) - margin;
        }
        if (seen) contents.sets[cell].push_back(p);
      }
    }
  }

  [[nodiscard]] polygon_bits seen_from(const std::array<float, 3>& eye) const {
    polygon_bits seen;
    for (std::uint32_t p = 0; p < polygons; ++p) {
      const region& r = regions_[p];
      bool inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto e = static_cast<double>(eye[axis]);
        inside = inside && e >= r.min[axis] && e <= r.max[axis];
      }
      seen[p] = inside;
    }
    return seen;
  }

 private:
  std::array<region, polygons> regions_;
};

// One coordinate of the next position: on a border of a box or of a grown box, a float next to one, or a small step.
float next_coordinate(const sample_contents& contents, random_source& random, std::size_t axis, float now) {
  if (random() % 4 != 0) return now + (static_cast<float>(random() % 1001) / 1000.0f - 0.5f) * 0.4f;
  const box& b = contents.cells[random() % contents.cells.size()];
  const float border = random() % 2 == 0 ? b.min[axis] : b.max[axis];
  const float grow = (static_cast<float>(random() % 3) - 1.0f) * contents.facts.margin;
  const float place = border + grow;
  const std::uint32_t side = random() % 3;
  return side == 0 ? place : std::nextafter(place, side == 1 ? -1e9f : 1e9f);
}

void walk(sample_contents contents, std::uint32_t seed, int steps) {
  const known_world world(contents, seed);
  const loaded_file file(contents);
  test_view view(file.db());
  random_source random(seed);
  std::array<float, 3> eye{1, 1, 1};
  polygon_bits shown;
  int inside_cells = 0;
  int kept = 0;
  std::size_t seen = 0;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t axis = 0; axis < 3; ++axis) eye[axis] = next_coordinate(contents, random, axis, eye[axis]);
    const sightcell_frame frame = view.move(eye[0], eye[1], eye[2]);
    if ((frame.flags & SIGHTCELL_FRAME_CHANGED) != 0) {
      shown.reset();
      for (const std::uint32_t p : view.polygons()) shown.set(p);
    }
    const polygon_bits needed = world.seen_from(eye);
    ASSERT_TRUE((needed & ~shown).none()) << "step " << step << " at " << eye[0] << " " << eye[1] << " " << eye[2];
    if (frame.cell == SIGHTCELL_NO_CELL) continue;
    const box& b = contents.cells[frame.cell];
    bool in_box = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto e = static_cast<double>(eye[axis]);
      const auto margin = static_cast<double>(contents.facts.margin);
      ASSERT_GE(e, static_cast<double>(b.min[axis]) - margin);
      ASSERT_LT(e, static_cast<double>(b.max[axis]) + margin);
      in_box = in_box && eye[axis] >= b.min[axis] && eye[axis] < b.max[axis];
    }
    ++inside_cells;
    kept += in_box ? 0 : 1;
    seen += needed.count();
  }
  EXPECT_GT(inside_cells, steps / 3) << "the walk must be inside cells";
  EXPECT_GT(kept, steps / 100) << "and in grown boxes";
  EXPECT_GT(seen, static_cast<std::size_t>(steps) / 10) << "and some polygons must be visible";
}

sample_contents world_of(std::uint32_t seed, std::uint32_t cells, bool overlapping) {
  return random_contents(seed, {.polygons = polygons, .draws = 12, .cells = cells, .overlapping = overlapping});
}

int steps() {
  return static_cast<int>(250'000 / case_step());
}

TEST(margin_walk, grid) {
  walk(world_of(1, 512, false), 11, steps());
}

TEST(margin_walk, overlapping_boxes) {
  walk(world_of(2, 60, true), 12, steps());
}

TEST(margin_walk, lattice_of_two_levels) {
  sample_contents contents = world_of(3, 400, false);
  put_on_lattice(contents);
  walk(contents, 13, steps());
}

// Widths that are not floats, so that every border is rounded.
TEST(margin_walk, lattice_with_rounded_borders) {
  sample_contents contents = world_of(4, 27 * 9, false);
  contents.facts.margin = 0.1f;
  contents.lattice = sightcell::format::lattice_shape{0.7, 1.1};
  for (int i = 0; i < 27 * 9; ++i) contents.places.push_back({i % 9 - 4, i / 9 % 3, i / 27 - 4, i % 5 == 0 ? 1u : 0u});
  std::sort(contents.places.begin(), contents.places.end(), sightcell::format::lattice_comes_before);
  for (std::size_t i = 0; i < contents.places.size(); ++i) {
    contents.cells[i] = sightcell::format::box_of(*contents.lattice, contents.places[i]);
  }
  walk(contents, 14, steps());
}

}  // namespace
