#include "cells/merge_tree.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace sightcell::bake {
namespace {

std::vector<std::size_t> children_of(const std::vector<merge_node>& tree, std::size_t node) {
  std::vector<std::size_t> children;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree[i].parent == node && i != node) children.push_back(i);
  return children;
}

bool contains(const lattice_position& outer, const lattice_position& inner) {
  const int shift = outer.level - inner.level;
  return inner.z >> shift == outer.z && inner.x >> shift == outer.x && outer.y <= inner.y &&
         inner.y + inner.layers <= outer.y + outer.layers;
}

TEST(merge_tree, joins_what_overlaps_and_keeps_storeys_apart) {
  const std::vector<lattice_position> cells{{.z = 0, .y = 0, .x = 0, .layers = 4},
                                            {.z = 0, .y = 6, .x = 0, .layers = 4},
                                            {.z = 0, .y = 2, .x = 1, .layers = 4},
                                            {.z = 1, .y = 9, .x = 1, .layers = 4}};
  const auto tree = make_merge_tree(cells, 1);
  ASSERT_EQ(tree.size(), 6u);
  EXPECT_EQ(tree[4].position, (lattice_position{.z = 0, .y = 0, .x = 0, .level = 1, .layers = 6}));
  EXPECT_EQ(tree[5].position, (lattice_position{.z = 0, .y = 6, .x = 0, .level = 1, .layers = 7})) << "touching";
  EXPECT_EQ(children_of(tree, 4), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(children_of(tree, 5), (std::vector<std::size_t>{1, 3}));
  EXPECT_TRUE(tree[4].may_be_cell && tree[5].may_be_cell);
}

TEST(merge_tree, a_node_with_little_floor_or_too_high_is_no_cell) {
  const auto few = make_merge_tree(std::vector<lattice_position>{{.x = 3, .layers = 4}}, 3);
  ASSERT_EQ(few.size(), 4u);
  EXPECT_TRUE(few[0].may_be_cell);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_FALSE(few[i].may_be_cell);
  std::vector<lattice_position> stairs;
  for (std::int64_t i = 0; i < 4; ++i) stairs.push_back({.z = i / 2, .y = 5 * i, .x = i % 2, .layers = 6});
  const auto high = make_merge_tree(stairs, 1);
  ASSERT_EQ(high.size(), 5u);
  EXPECT_EQ(high[4].position.layers, 21);
  EXPECT_FALSE(high[4].may_be_cell);
}

// Random cells: each node contains its children, nodes of a level are disjoint, and what no child covers is the rest.
TEST(merge_tree, nodes_are_around_their_children_and_disjoint) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<lattice_position> cells;
    for (std::int64_t z = -8; z < 0; ++z)
      for (std::int64_t x = 8; x < 16; ++x)
        for (std::int64_t y = random() % 12; y < 40; y += 8 + static_cast<std::int64_t>(random() % 30))
          cells.push_back({.z = z, .y = y, .x = x, .layers = static_cast<std::int32_t>(1 + random() % 8)});
    const auto tree = make_merge_tree(cells, 3);
    for (std::size_t i = 0; i < tree.size(); ++i) {
      ASSERT_TRUE(tree[i].parent >= i && tree[i].parent < tree.size());
      const std::size_t parent = tree[i].parent;
      EXPECT_EQ(parent == i, tree[i].position.level == 3);
      EXPECT_TRUE(contains(tree[parent].position, tree[i].position));
      // Layer by layer of each column.
      const lattice_position& at = tree[i].position;
      const auto children = children_of(tree, i);
      if (children.empty()) continue;
      const auto uncovered = uncovered_by_children(tree, i, children);
      for (std::int64_t z = at.z << at.level; z < (at.z + 1) << at.level; ++z)
        for (std::int64_t x = at.x << at.level; x < (at.x + 1) << at.level; ++x)
          for (std::int64_t y = at.y; y < at.y + at.layers; ++y) {
            int covers = 0;
            for (const std::size_t child : children) covers += contains(tree[child].position, {.z = z, .y = y, .x = x});
            for (const column_part& part : uncovered)
              covers += part.z == z && part.x == x && part.first <= y && y < part.end;
            ASSERT_EQ(covers, 1);
          }
    }
  }
}

}  // namespace
}  // namespace sightcell::bake
