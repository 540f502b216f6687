#include "box_tree.h"

#include <algorithm>
#include <array>

namespace sightcell::runtime {
namespace {

constexpr std::uint32_t leaf_size = 4;
// Splits halve the number of cells, and there are at most 2^24 of them: 64 is far more than a path can hold.
constexpr std::size_t stack_size = 64;

format::box bounds_of(std::span<const located_cell> cells) noexcept {
  format::box all = cells.front().bounds;
  for (const located_cell& c : cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all.min[axis] = std::min(all.min[axis], c.bounds.min[axis]);
      all.max[axis] = std::max(all.max[axis], c.bounds.max[axis]);
    }
  }
  return all;
}

double twice_center(const located_cell& c, std::size_t axis) noexcept {
  return static_cast<double>(c.bounds.min[axis]) + static_cast<double>(c.bounds.max[axis]);
}

// The axis along which the centers lie farthest apart.
std::size_t split_axis(std::span<const located_cell> cells) noexcept {
  std::size_t best = 0;
  double longest = -1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = twice_center(cells.front(), axis);
    double high = low;
    for (const located_cell& c : cells) {
      low = std::min(low, twice_center(c, axis));
      high = std::max(high, twice_center(c, axis));
    }
    if (high - low > longest) {
      longest = high - low;
      best = axis;
    }
  }
  return best;
}

struct pending_node {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t parent = no_cell;  // whose second child this is; no_cell for a first child and the root
};

}  // namespace

std::uint32_t box_tree::node_count(std::uint32_t cells) noexcept {
  if (cells == 0) return 0;
  if (cells <= leaf_size) return 1;
  const std::uint32_t half = cells / 2;
  // Both halves have the same tree unless the number is odd, which keeps this from visiting every node.
  const std::uint32_t first = node_count(half);
  return 1 + first + (cells % 2 == 0 ? first : node_count(cells - half));
}

void box_tree::build(std::span<located_cell> cells, std::span<tree_node> nodes) noexcept {
  cells_ = cells;
  nodes_ = nodes;
  if (cells.empty()) return;
  std::array<pending_node, stack_size> stack;
  std::size_t depth = 0;
  std::uint32_t used = 0;
  stack[depth++] = {0, static_cast<std::uint32_t>(cells.size()), no_cell};
  while (depth > 0) {
    const pending_node task = stack[--depth];
    const std::span<located_cell> own = cells.subspan(task.begin, task.end - task.begin);
    const std::uint32_t number = used++;
    if (task.parent != no_cell) nodes[task.parent].first = number;
    tree_node node;
    node.bounds = bounds_of(own);
    node.smallest_volume = any_volume;
    for (const located_cell& c : own) node.smallest_volume = std::min(node.smallest_volume, volume_of(c.bounds));
    if (own.size() <= leaf_size) {
      node.first = task.begin;
      node.count = static_cast<std::uint32_t>(own.size());
    } else {
      const std::size_t axis = split_axis(own);
      const std::uint32_t half = static_cast<std::uint32_t>(own.size() / 2);
      std::nth_element(own.begin(), own.begin() + half, own.end(), [axis](const auto& a, const auto& b) {
        const double left = twice_center(a, axis);
        const double right = twice_center(b, axis);
        return left < right || (left == right && a.cell < b.cell);
      });
      stack[depth++] = {task.begin + half, task.end, number};
      stack[depth++] = {task.begin, task.begin + half, no_cell};
    }
    nodes[number] = node;
  }
}

// Calls visit(cells) for every leaf below nodes that enters(node) lets through, until it says no.
template <class Enters, class Visit>
void box_tree::walk(const Enters& enters, const Visit& visit) const noexcept {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, stack_size> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const tree_node& node = nodes_[number];
    if (!enters(node)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = number + 1;
    } else if (!visit(cells_.subspan(node.first, node.count))) {
      return;
    }
  }
}

std::uint32_t box_tree::find(const point& place, double volume_limit, format::box& out) const noexcept {
  std::uint32_t best = no_cell;
  double best_volume = volume_limit;
  const auto enters = [&](const tree_node& node) {
    const bool too_large =
        node.smallest_volume > best_volume || (best == no_cell && node.smallest_volume >= volume_limit);
    return !too_large && holds(node.bounds, place);
  };
  walk(enters, [&](std::span<const located_cell> cells) {
    for (const located_cell& c : cells) {
      if (!holds(c.bounds, place)) continue;
      const double volume = volume_of(c.bounds);
      if (volume < best_volume || (best != no_cell && volume == best_volume && c.cell < best)) {
        best_volume = volume;
        best = c.cell;
        out = c.bounds;
      }
    }
    return true;
  });
  return best;
}

bool box_tree::has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept {
  const wide_box inside = widened(bounds);
  const auto enters = [&](const tree_node& node) {
    return node.smallest_volume < volume_limit && boxes_meet(widened(node.bounds), inside);
  };
  bool found = false;
  walk(enters, [&](std::span<const located_cell> cells) {
    found = std::any_of(cells.begin(), cells.end(), [&](const located_cell& c) {
      return volume_of(c.bounds) < volume_limit && boxes_meet(widened(c.bounds), inside);
    });
    return !found;
  });
  return found;
}

std::size_t box_tree::touching(const wide_box& closed, std::span<located_cell> dst) const noexcept {
  std::size_t found = 0;
  const auto enters = [&](const tree_node& node) { return touches(closed, widened(node.bounds)); };
  walk(enters, [&](std::span<const located_cell> cells) {
    for (const located_cell& c : cells) {
      if (!touches(closed, widened(c.bounds))) continue;
      if (found < dst.size()) dst[found] = c;
      if (++found > dst.size()) return false;
    }
    return true;
  });
  return found;
}

// The nearer child first, so that the farther one is mostly out of reach.
void box_tree::nearest(nearest_search& search) const noexcept {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, stack_size> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const tree_node& node = nodes_[number];
    if (search.out_of_reach(widened(node.bounds))) continue;
    if (node.count == 0) {
      const bool second_first =
          search.distance_to(nodes_[node.first].bounds) < search.distance_to(nodes_[number + 1].bounds);
      stack[depth++] = second_first ? number + 1 : node.first;
      stack[depth++] = second_first ? node.first : number + 1;
      continue;
    }
    for (const located_cell& c : cells_.subspan(node.first, node.count)) search.take(c.bounds, c.cell);
  }
}

}  // namespace sightcell::runtime
