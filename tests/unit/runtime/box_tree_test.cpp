#include "box_tree.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "built_tree.h"
#include "unit/format/random_source.h"

namespace {

using namespace sightcell::runtime;
using sightcell::format::box;
using sightcell::test::built_tree;
using sightcell::test::random_source;
using sightcell::test::slow_find;

std::vector<box> random_boxes(random_source& random, std::uint32_t count) {
  std::vector<box> boxes;
  for (std::uint32_t i = 0; i < count; ++i) {
    box b;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      b.min[axis] = static_cast<float>(random() % 24) * 0.5f - 6.0f;
      b.max[axis] = b.min[axis] + static_cast<float>(1 + random() % 9) * 0.5f;
    }
    boxes.push_back(b);
  }
  return boxes;
}

TEST(box_tree, agrees_with_trying_every_box) {
  random_source random(41);
  for (const std::uint32_t count : {0u, 1u, 2u, 4u, 5u, 9u, 100u, 1000u}) {
    const auto boxes = random_boxes(random, count);
    const built_tree built(boxes);
    for (int round = 0; round < 3000; ++round) {
      // Multiples of a quarter are on borders as often as inside.
      point eye;
      for (double& e : eye) e = (random() % 80) * 0.25 - 8.0;
      const double limit = round % 3 == 0 ? static_cast<double>(random() % 40) / 8.0 : any_volume;
      box found{{9, 9, 9}, {9, 9, 9}};
      const std::uint32_t cell = built.tree.find(rounded_down(eye), limit, found);
      ASSERT_EQ(cell, slow_find(boxes, eye, limit));
      ASSERT_EQ(found.min, cell == no_cell ? (std::array<float, 3>{9, 9, 9}) : boxes[cell].min);
    }
  }
}

// Boxes in a row are in its order except inside a leaf, wherever their ends are; boxes at one position are in the order
// of their numbers.
TEST(box_tree, parts_are_the_first_and_the_last_along_an_axis) {
  random_source random(47);
  const auto even = [&] { return static_cast<float>(random() % 1000); };
  const auto powers = [&] { return std::ldexp(1.0f, static_cast<int>(random() % 240) - 120); };
  const auto one = [] { return 1.0f; };
  for (const std::function<float()>& place : {std::function<float()>(even), {powers}, {one}}) {
    std::vector<box> boxes;
    for (int i = 0; i < 1000; ++i) {
      const float x = place();
      boxes.push_back({{x, 0.0f, 0.0f}, {2.0f * x + 1.0f, 1.0f, 1.0f}});
    }
    const built_tree built(boxes);
    for (const std::uint32_t middle : {500u, 250u, 750u, 125u}) {
      const std::uint32_t reach = middle == 500 ? 500 : middle == 125 ? 125 : 250;
      const auto order_of = [&](std::uint32_t at) {
        const located_cell& c = built.tree.cells()[at];
        return std::pair(static_cast<double>(c.bounds.min[0]) + static_cast<double>(c.bounds.max[0]), c.cell);
      };
      for (std::uint32_t i = 1; i <= reach; ++i) {
        for (std::uint32_t k = 0; k < reach; k += 7) ASSERT_LT(order_of(middle - i), order_of(middle + k)) << middle;
      }
    }
  }
}

TEST(box_tree, smaller_cells_inside_a_box) {
  random_source random(42);
  for (const std::uint32_t count : {0u, 1u, 10u, 300u}) {
    const auto boxes = random_boxes(random, count);
    const built_tree built(boxes);
    for (const box& place : random_boxes(random, 1000)) {
      const double limit = static_cast<double>(random() % 200) / 16.0;
      bool expected = false;
      for (const box& b : boxes) {
        bool meet = volume_of(b) < limit;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          meet = meet && std::max(b.min[axis], place.min[axis]) < std::min(b.max[axis], place.max[axis]);
        }
        expected = expected || meet;
      }
      ASSERT_EQ(built.tree.has_smaller_inside(place, limit), expected);
    }
  }
}

TEST(box_tree, many_equal_boxes) {
  const std::vector<box> boxes(5000, {{0, 0, 0}, {1, 1, 1}});
  const built_tree built(boxes);
  const point eye{0.5, 0.0, 0.999};
  box found;
  EXPECT_EQ(built.tree.find(rounded_down(eye), any_volume, found), 0u);
  EXPECT_EQ(built.tree.find(rounded_down(eye), 1.0, found), no_cell);
}

TEST(box_tree, boxes_are_half_open) {
  const box b{{0, 0, 0}, {1, 1, 1}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const wide_box grown = widened(b, 0.25f);
    point eye{0.5, 0.5, 0.5};
    eye[axis] = 0.0;
    EXPECT_TRUE(holds(b, rounded_down(eye)));
    eye[axis] = std::nextafter(1.0, 0.0);
    EXPECT_TRUE(holds(b, rounded_down(eye)));
    eye[axis] = 1.0;
    EXPECT_FALSE(holds(b, rounded_down(eye)));
    EXPECT_TRUE(holds(grown, eye));
    eye[axis] = 1.25;
    EXPECT_FALSE(holds(grown, eye));
    eye[axis] = -0.25;
    EXPECT_TRUE(holds(grown, eye));
    eye[axis] = std::nextafter(-0.25, -1.0);
    EXPECT_FALSE(holds(grown, eye));
    eye[axis] = std::nan("");
    EXPECT_FALSE(holds(b, rounded_down(eye)));
    EXPECT_FALSE(holds(grown, eye));
  }
}

TEST(box_tree, huge_and_tiny_boxes) {
  const float huge = std::numeric_limits<float>::max();
  const float tiny = std::numeric_limits<float>::denorm_min();
  const std::vector<box> boxes{{{-huge, -huge, -huge}, {huge, huge, huge}}, {{0, 0, 0}, {tiny, tiny, tiny}}};
  const built_tree built(boxes);
  const point origin{0, 0, 0};
  const point away{1, 2, 3};
  box found;
  EXPECT_EQ(built.tree.find(rounded_down(origin), any_volume, found), 1u);
  EXPECT_EQ(built.tree.find(rounded_down(away), any_volume, found), 0u);
}

TEST(cell_box, neighbors_of_numbers) {
  random_source random(43);
  constexpr float infinite = std::numeric_limits<float>::infinity();
  std::vector<float> values{0.0f,
                            -0.0f,
                            1.0f,
                            -1.0f,
                            std::numeric_limits<float>::max(),
                            infinite,
                            std::numeric_limits<float>::denorm_min(),
                            -std::numeric_limits<float>::denorm_min()};
  for (int i = 0; i < 1000; ++i) {
    const float v = std::bit_cast<float>(random());
    if (std::isfinite(v)) values.push_back(v);
  }
  for (const float v : values) {
    EXPECT_EQ(next_below(v), std::nextafter(v, -infinite)) << v;
    const double wide = static_cast<double>(v) * 1.1;
    if (std::isfinite(wide)) {
      EXPECT_EQ(next_above(wide), std::nextafter(wide, any_volume)) << wide;
    }
    for (const double place : {static_cast<double>(v), std::nextafter(static_cast<double>(v), 0.0), wide}) {
      const float below = rounded_down({place, 0.0, 0.0})[0];
      EXPECT_LE(static_cast<double>(below), place);
      EXPECT_GT(static_cast<double>(std::nextafter(below, infinite)), place == any_volume ? 0.0 : place);
    }
  }
}

}  // namespace
