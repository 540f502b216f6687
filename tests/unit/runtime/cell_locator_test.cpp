#include "cell_locator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "unit/format/random_source.h"

namespace {

using namespace sightcell::runtime;
using sightcell::format::box;
using sightcell::test::random_source;

struct built_locator {
  explicit built_locator(const std::vector<box>& boxes)
      : nodes(cell_locator::node_count(static_cast<std::uint32_t>(boxes.size()))) {
    for (const box& b : boxes) cells.push_back({b, static_cast<std::uint32_t>(cells.size())});
    locator.build(cells, nodes);
  }
  std::vector<located_cell> cells;
  std::vector<locator_node> nodes;
  cell_locator locator;
};

std::uint32_t slow_find(const std::vector<box>& boxes, const float eye[3], double limit) {
  std::uint32_t best = no_cell;
  double volume = limit;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (box_holds(boxes[i], eye) && box_volume(boxes[i]) < volume) {
      best = i;
      volume = box_volume(boxes[i]);
    }
  }
  return best;
}

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

TEST(cell_locator, agrees_with_trying_every_box) {
  random_source random(41);
  for (const std::uint32_t count : {0u, 1u, 2u, 4u, 5u, 9u, 100u, 1000u}) {
    const auto boxes = random_boxes(random, count);
    const built_locator built(boxes);
    for (int round = 0; round < 3000; ++round) {
      // Multiples of a quarter lie on borders as often as inside.
      float eye[3];
      for (float& e : eye) e = static_cast<float>(random() % 80) * 0.25f - 8.0f;
      const double limit = round % 3 == 0 ? static_cast<double>(random() % 40) / 8.0 : any_volume;
      box found{{9, 9, 9}, {9, 9, 9}};
      const std::uint32_t cell = built.locator.find(eye, limit, found);
      ASSERT_EQ(cell, slow_find(boxes, eye, limit));
      ASSERT_EQ(found.min, cell == no_cell ? (std::array<float, 3>{9, 9, 9}) : boxes[cell].min);
    }
  }
}

TEST(cell_locator, smaller_cells_inside_a_box) {
  random_source random(42);
  for (const std::uint32_t count : {0u, 1u, 10u, 300u}) {
    const auto boxes = random_boxes(random, count);
    const built_locator built(boxes);
    for (const box& place : random_boxes(random, 1000)) {
      const double limit = static_cast<double>(random() % 200) / 16.0;
      bool expected = false;
      for (const box& b : boxes) {
        bool meet = box_volume(b) < limit;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          meet = meet && std::max(b.min[axis], place.min[axis]) < std::min(b.max[axis], place.max[axis]);
        }
        expected = expected || meet;
      }
      ASSERT_EQ(built.locator.has_smaller_inside(place, limit), expected);
    }
  }
}

TEST(cell_locator, many_equal_boxes) {
  const std::vector<box> boxes(5000, {{0, 0, 0}, {1, 1, 1}});
  const built_locator built(boxes);
  const float eye[3] = {0.5f, 0.0f, 0.999f};
  box found;
  EXPECT_EQ(built.locator.find(eye, any_volume, found), 0u);
  EXPECT_EQ(built.locator.find(eye, 1.0, found), no_cell);
}

TEST(cell_locator, boxes_are_half_open) {
  const box b{{0, 0, 0}, {1, 1, 1}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float eye[3] = {0.5f, 0.5f, 0.5f};
    eye[axis] = 0.0f;
    EXPECT_TRUE(box_holds(b, eye));
    eye[axis] = std::nextafter(1.0f, 0.0f);
    EXPECT_TRUE(box_holds(b, eye));
    eye[axis] = 1.0f;
    EXPECT_FALSE(box_holds(b, eye));
    EXPECT_TRUE(grown_box_holds(b, 0.25f, eye));
    eye[axis] = 1.25f;
    EXPECT_FALSE(grown_box_holds(b, 0.25f, eye));
    eye[axis] = -0.25f;
    EXPECT_TRUE(grown_box_holds(b, 0.25f, eye));
    eye[axis] = std::nextafter(-0.25f, -1.0f);
    EXPECT_FALSE(grown_box_holds(b, 0.25f, eye));
    eye[axis] = std::nanf("");
    EXPECT_FALSE(box_holds(b, eye));
    EXPECT_FALSE(grown_box_holds(b, 0.25f, eye));
  }
}

TEST(cell_locator, huge_and_tiny_boxes) {
  const float huge = std::numeric_limits<float>::max();
  const float tiny = std::numeric_limits<float>::denorm_min();
  const std::vector<box> boxes{{{-huge, -huge, -huge}, {huge, huge, huge}}, {{0, 0, 0}, {tiny, tiny, tiny}}};
  const built_locator built(boxes);
  const float origin[3] = {0, 0, 0};
  const float away[3] = {1, 2, 3};
  box found;
  EXPECT_EQ(built.locator.find(origin, any_volume, found), 1u);
  EXPECT_EQ(built.locator.find(away, any_volume, found), 0u);
}

}  // namespace
