#include "lattice_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "built_tree.h"
#include "cell_locator.h"
#include "unit/case_step.h"
#include "unit/format/random_source.h"
#include "unit/format/sample_contents.h"

namespace {

using namespace sightcell::runtime;
using sightcell::format::box;
using sightcell::format::lattice_place;
using sightcell::format::lattice_shape;
using sightcell::test::built_tree;
using sightcell::test::random_source;
using sightcell::test::sample_contents;
using sightcell::test::slow_find;

// Cells on a lattice, indexed from the bytes of a file.
struct built_lattice {
  built_lattice(const lattice_shape& shape, std::vector<lattice_place> places) {
    sample_contents contents;
    sightcell::test::add_draws(contents, 1, 1);
    std::sort(places.begin(), places.end(), sightcell::format::lattice_comes_before);
    contents.lattice = shape;
    for (const lattice_place& p : places) {
      boxes.push_back(sightcell::format::box_of(shape, p));
      contents.sets.emplace_back();
    }
    contents.places = std::move(places);
    contents.cells = boxes;
    bytes = contents.encode();
    EXPECT_EQ(sightcell::format::reader::open(bytes, file), sightcell::format::status::ok);
    slots.resize(lattice_index::slot_count(file.lattice()->chunk_count()));
    EXPECT_TRUE(index.build(*file.lattice(), file.cell_count(), slots));
  }
  std::vector<box> boxes;
  std::vector<std::byte> bytes;
  sightcell::format::reader file;
  std::vector<lattice_slot> slots;
  lattice_index index;
};

// Positions of several levels around a center; those of different levels overlap.
std::vector<lattice_place> random_places(random_source& random, int count, std::uint32_t levels, int middle) {
  std::set<std::tuple<std::uint32_t, int, int, int>> taken;
  std::vector<lattice_place> places;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t level = random() % levels;
    const int scale = 1 << level;
    const auto spot = [&](std::uint32_t range) {
      return middle * scale + static_cast<int>(random() % (range * static_cast<std::uint32_t>(scale))) -
             static_cast<int>(range / 2) * scale;
    };
    const lattice_place p{spot(24), spot(4), spot(24), level};
    if (taken.insert({p.level, p.x, p.y, p.z}).second) places.push_back(p);
  }
  return places;
}

// A position near some cell: on its border, a float next to it, or anywhere in it.
point place_near(random_source& random, const std::vector<box>& boxes) {
  const box& b = boxes[random() % boxes.size()];
  point p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(b.min[axis]);
    const double high = static_cast<double>(b.max[axis]);
    const std::uint32_t kind = random() % 6;
    const double border = random() % 2 == 0 ? low : high;
    p[axis] = kind < 3    ? low + (high - low) * (random() % 1001) / 1000.0
              : kind == 3 ? border
              : kind == 4 ? std::nextafter(border, -any_volume)
                          : border + (high - low) * ((random() % 401) / 100.0 - 2.0);
  }
  return p;
}

struct lattice_case {
  lattice_shape shape;
  std::uint32_t levels;
  int middle;  // position on level 0
};

// The last two: borders that rounding moves by up to a fifth of a cell, and by more than whole cells of level 2.
const lattice_case cases[] = {{{4.0, 2.0}, 1, 0},      {{4.0, 2.0}, 3, 0},           {{0.3, 0.7}, 2, -1000},
                              {{1.7, 1.1}, 3, 60'000}, {{0.01, 0.01}, 1, 3'000'000}, {{0.003, 0.003}, 3, 8'000'000}};

TEST(lattice_index, agrees_with_trying_every_box) {
  random_source random(71);
  for (const lattice_case& c : cases) {
    const auto all = random_places(random, 700, c.levels, c.middle);
    std::vector<lattice_place> valid;
    for (const lattice_place& p : all) {
      const box b = sightcell::format::box_of(c.shape, p);
      if (b.min[0] < b.max[0] && b.min[1] < b.max[1] && b.min[2] < b.max[2]) valid.push_back(p);
    }
    ASSERT_GT(valid.size(), 50u);
    const built_lattice built(c.shape, valid);
    int found_cells = 0;
    for (std::size_t round = 0; round < 20000; round += sightcell::test::case_step()) {
      const point eye = place_near(random, built.boxes);
      const double limit = round % 3 == 0 ? volume_of(built.boxes[random() % built.boxes.size()]) : any_volume;
      box found{{9, 9, 9}, {9, 9, 9}};
      const std::uint32_t cell = built.index.find(rounded_down(eye), limit, found);
      ASSERT_EQ(cell, slow_find(built.boxes, eye, limit)) << eye[0] << " " << eye[1] << " " << eye[2];
      ASSERT_EQ(found.max, cell == no_cell ? (std::array<float, 3>{9, 9, 9}) : built.boxes[cell].max);
      found_cells += cell == no_cell ? 0 : 1;
    }
    EXPECT_GT(found_cells, 1000 / static_cast<int>(sightcell::test::case_step()));
  }
}

TEST(lattice_index, smaller_cells_inside_a_cell) {
  random_source random(72);
  for (const lattice_case& c : cases) {
    const built_lattice built(c.shape, random_places(random, 60, c.levels, std::min(c.middle, 60'000)));
    for (const box& b : built.boxes) {
      bool expected = false;
      for (const box& other : built.boxes) {
        expected = expected || (volume_of(other) < volume_of(b) && boxes_meet(widened(other), widened(b)));
      }
      // Never false where there is one; true without one only where rounding is coarse.
      const bool answer = built.index.has_smaller_inside(b, volume_of(b));
      ASSERT_TRUE(answer || !expected);
      if (c.shape.width > 1.0) {
        ASSERT_EQ(answer, expected);
      }
    }
  }
}

std::vector<std::uint32_t> numbers_of(std::span<const located_cell> cells) {
  std::vector<std::uint32_t> numbers;
  for (const located_cell& c : cells) numbers.push_back(c.cell);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

TEST(lattice_index, cells_that_a_box_touches) {
  random_source random(73);
  for (const lattice_case& c : cases) {
    const built_lattice built(c.shape, random_places(random, 300, c.levels, std::min(c.middle, 60'000)));
    std::vector<located_cell> room(built.boxes.size());
    for (int round = 0; round < 1000; ++round) {
      wide_box closed{place_near(random, built.boxes), place_near(random, built.boxes)};
      if (round % 10 == 0) closed.max = closed.min;
      if (round % 50 == 1) closed.max = {1e30, 1e30, 1e30};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (closed.min[axis] > closed.max[axis]) std::swap(closed.min[axis], closed.max[axis]);
      }
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < built.boxes.size(); ++i) {
        if (touches(closed, widened(built.boxes[i]))) expected.push_back(i);
      }
      const std::size_t count = built.index.touching(closed, room);
      ASSERT_EQ(numbers_of(std::span(room).first(count)), expected);
      if (expected.size() > 2) {
        ASSERT_EQ(built.index.touching(closed, std::span(room).first(2)), 3u) << "one more than there is room for";
      }
    }
  }
}

TEST(lattice_index, nearest_cell_and_its_slack) {
  random_source random(74);
  for (const lattice_case& c : {cases[0], cases[1], cases[2], cases[3]}) {
    const built_lattice built(c.shape, random_places(random, 200, c.levels, c.middle));
    const built_tree tree(built.boxes);
    for (int round = 0; round < 1000; ++round) {
      point eye = place_near(random, built.boxes);
      for (double& e : eye) e += (random() % 2001 - 1000.0) * 0.02;
      const auto slow = [&](const point& p) {
        nearest_search all(p);
        for (std::uint32_t i = 0; i < built.boxes.size(); ++i) all.take(built.boxes[i], i);
        return all;
      };
      nearest_search by_index(eye);
      built.index.nearest(by_index);
      nearest_search by_tree(eye);
      tree.tree.nearest(by_tree);
      const nearest_search expected = slow(eye);
      ASSERT_EQ(by_index.cell(), expected.cell());
      ASSERT_EQ(by_tree.cell(), expected.cell());
      ASSERT_EQ(by_index.distance(), expected.distance());
      ASSERT_EQ(by_index.slack(), expected.slack());
      ASSERT_EQ(by_tree.slack(), expected.slack());
      // Within the slack, no other cell is nearer.
      for (int turn = 0; turn < 4; ++turn) {
        point moved = eye;
        const std::size_t axis = random() % 3;
        moved[axis] += (turn % 2 == 0 ? 1.0 : -1.0) * expected.slack();
        ASSERT_LE(squared_distance(widened(built.boxes[expected.cell()]), moved),
                  slow(moved).distance() * slow(moved).distance() * (1.0 + 1e-12));
      }
    }
  }
}

TEST(lattice_index, positions_far_away_and_nan) {
  const built_lattice built({4.0, 2.0}, {{0, 0, 0, 0}, {(1 << 23) - 8, 0, 0, 0}, {-(1 << 23), 5, 0, 0}});
  box found;
  EXPECT_EQ(built.index.find({1, 1, 1}, any_volume, found), slow_find(built.boxes, {1, 1, 1}, any_volume));
  for (const double far : {4.0 * ((1 << 23) - 8), -4.0 * (1 << 23), 1e10, -1e10, 1e300, any_volume, -any_volume,
                           static_cast<double>(std::nanf(""))}) {
    for (const double up : {1.0, 10.0, far}) {
      const point eye{far, up, 1.0};
      EXPECT_EQ(built.index.find(rounded_down(eye), any_volume, found), slow_find(built.boxes, eye, any_volume)) << far;
    }
  }
}

// So far from the origin that borders are rounded by more than a cell of level 0, whose box equals that of a cell of
// level 1. Of boxes of one size the lowest number wins, not the finer level.
TEST(lattice_index, where_rounding_makes_levels_equal) {
  constexpr int far = 1 << 24;
  const built_lattice built({1.0, 1.0}, {{far + 1, far + 1, far + 1, 0}, {2 * far + 2, 2 * far + 2, 2 * far + 2, 1}});
  ASSERT_EQ(built.boxes[0].min, built.boxes[1].min);
  ASSERT_EQ(built.boxes[0].max, built.boxes[1].max);
  box found;
  const point eye{far + 0.5, far + 0.5, far + 0.5};
  EXPECT_EQ(built.index.find(rounded_down(eye), any_volume, found), 0u);
  EXPECT_TRUE(built.index.has_smaller_inside(built.boxes[0], volume_of(built.boxes[0]))) << "maybe";
}

// "In at most 1 byte per cell": what a square of 1,000 x 1,000 cells takes.
TEST(lattice_index, a_million_cells_take_less_than_a_byte_each) {
  const std::uint64_t chunks = 125 * 125;
  EXPECT_LE(lattice_index::slot_count(chunks) * sizeof(lattice_slot), 1'000'000u);
}

TEST(lattice_index, bytes_that_changed_since_open) {
  random_source random(75);
  const built_lattice built({4.0, 2.0}, random_places(random, 400, 2, 0));
  const std::size_t at = sightcell::test::section_offset(built.bytes, 2);
  const std::size_t end =
      at + sightcell::test::get_u64(built.bytes, sightcell::test::section_place(built.bytes, 2) + 16);
  int rejected = 0;
  for (std::size_t i = at + 24; i < end; ++i) {
    std::vector<std::byte> bytes = built.bytes;
    sightcell::format::reader file;
    ASSERT_EQ(sightcell::format::reader::open(bytes, file), sightcell::format::status::ok);
    bytes[i] ^= static_cast<std::byte>(1 + random() % 255);
    std::vector<lattice_slot> slots(lattice_index::slot_count(file.lattice()->chunk_count()));
    lattice_index index;
    if (!index.build(*file.lattice(), file.cell_count(), slots)) {
      ++rejected;
      continue;
    }
    for (int round = 0; round < 20; ++round) {
      box found;
      const std::uint32_t cell = index.find(rounded_down(place_near(random, built.boxes)), any_volume, found);
      ASSERT_TRUE(cell == no_cell || cell < file.cell_count());
    }
  }
  EXPECT_GT(rejected, 100);
}

}  // namespace
