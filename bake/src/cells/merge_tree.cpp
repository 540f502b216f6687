#include "cells/merge_tree.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace sightcell::bake {
namespace {

std::int64_t end_of(const lattice_position& p) {
  return p.y + p.layers;
}

std::uint64_t column_bit(const lattice_position& p) {
  return std::uint64_t{1} << (8 * (p.z & 7) + (p.x & 7));
}

bool may_be_cell(const merge_node& node) {
  const std::int64_t side = std::int64_t{1} << node.position.level;
  return 2 * std::int64_t{std::popcount(node.floors)} >= side * side &&
         node.position.layers <= lattice::layers_per_width * side;
}

}  // namespace

std::vector<merge_node> make_merge_tree(std::span<const lattice_position> cells, std::int32_t highest) {
  std::vector<merge_node> tree;
  for (std::size_t i = 0; i < cells.size(); ++i) tree.push_back({cells[i], i, column_bit(cells[i]), true});
  for (std::size_t below = 0, level = 1; level <= static_cast<std::size_t>(highest); ++level) {
    const std::size_t end = tree.size();
    std::vector<std::size_t> order;
    for (std::size_t i = below; i < end; ++i) order.push_back(i);
    const auto key = [&](std::size_t i) {
      const lattice_position& p = tree[i].position;
      return std::tuple(p.z >> 1, p.x >> 1, p.y, p.z, p.x, p.layers);
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    for (const std::size_t child : order) {
      const lattice_position at = tree[child].position;
      const bool joins = tree.size() > end && tree.back().position.z == at.z >> 1 &&
                         tree.back().position.x == at.x >> 1 && at.y < end_of(tree.back().position);
      if (!joins) tree.push_back({{at.z >> 1, at.y, at.x >> 1, at.level + 1, at.layers}, tree.size()});
      merge_node& parent = tree.back();
      parent.position.layers =
          static_cast<std::int32_t>(std::max(end_of(parent.position), end_of(at)) - parent.position.y);
      parent.floors |= tree[child].floors;
      tree[child].parent = tree.size() - 1;
    }
    for (std::size_t i = end; i < tree.size(); ++i) tree[i].may_be_cell = may_be_cell(tree[i]);
    below = end;
  }
  return tree;
}

std::vector<column_part> uncovered_by_children(std::span<const merge_node> tree, std::size_t node,
                                               std::span<const std::size_t> children) {
  const lattice_position& at = tree[node].position;
  const std::int64_t side = std::int64_t{1} << at.level;
  std::vector<column_part> parts;
  for (std::int64_t z = at.z * side; z < (at.z + 1) * side; ++z)
    for (std::int64_t x = at.x * side; x < (at.x + 1) * side; ++x) {
      // Children are in the order of their heights.
      std::int64_t low = at.y;
      for (const std::size_t child : children) {
        const lattice_position& inside = tree[child].position;
        if (inside.z != z >> inside.level || inside.x != x >> inside.level) continue;
        if (inside.y > low) parts.push_back({z, x, low, inside.y});
        low = std::max(low, end_of(inside));
      }
      if (low < end_of(at)) parts.push_back({z, x, low, end_of(at)});
    }
  return parts;
}

}  // namespace sightcell::bake
