#pragma once
// Cells in a tree, and the slow way to find one.
#include <cstdint>
#include <vector>

#include "box_tree.h"

namespace sightcell::test {

struct built_tree {
  explicit built_tree(const std::vector<format::box>& boxes)
      : nodes(runtime::box_tree::node_count(static_cast<std::uint32_t>(boxes.size()))) {
    for (const format::box& b : boxes) cells.push_back({b, static_cast<std::uint32_t>(cells.size())});
    tree.build(cells, nodes);
  }
  std::vector<runtime::located_cell> cells;
  std::vector<runtime::tree_node> nodes;
  runtime::box_tree tree;
};

// Tests every box.
inline std::uint32_t slow_find(const std::vector<format::box>& boxes, const runtime::point& eye, double limit) {
  std::uint32_t best = runtime::no_cell;
  double volume = limit;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (runtime::holds(runtime::widened(boxes[i]), eye) && runtime::volume_of(boxes[i]) < volume) {
      best = i;
      volume = runtime::volume_of(boxes[i]);
    }
  }
  return best;
}

}  // namespace sightcell::test
