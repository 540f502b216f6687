#include "cell_locator.h"

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

// Half-open boxes that only touch have no point in common.
bool boxes_meet(const format::box& a, const format::box& b) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(a.min[axis] < b.max[axis] && b.min[axis] < a.max[axis])) return false;
  }
  return true;
}

struct pending_node {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t parent = no_cell;  // whose second child this is; no_cell for a first child and the root
};

}  // namespace

bool box_holds(const format::box& b, const float eye[3]) noexcept {
  return eye[0] >= b.min[0] && eye[0] < b.max[0] && eye[1] >= b.min[1] && eye[1] < b.max[1] && eye[2] >= b.min[2] &&
         eye[2] < b.max[2];
}

bool grown_box_holds(const format::box& b, float margin, const float eye[3]) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double place = static_cast<double>(eye[axis]);
    const double grow = static_cast<double>(margin);
    if (!(place >= static_cast<double>(b.min[axis]) - grow && place < static_cast<double>(b.max[axis]) + grow)) {
      return false;
    }
  }
  return true;
}

double box_volume(const format::box& b) noexcept {
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume *= static_cast<double>(b.max[axis]) - static_cast<double>(b.min[axis]);
  }
  return volume;
}

std::uint32_t cell_locator::node_count(std::uint32_t cells) noexcept {
  if (cells == 0) return 0;
  if (cells <= leaf_size) return 1;
  const std::uint32_t half = cells / 2;
  // Both halves have the same tree unless the number is odd, which keeps this from visiting every node.
  const std::uint32_t first = node_count(half);
  return 1 + first + (cells % 2 == 0 ? first : node_count(cells - half));
}

void cell_locator::build(std::span<located_cell> cells, std::span<locator_node> nodes) noexcept {
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
    locator_node node;
    node.bounds = bounds_of(own);
    node.smallest_volume = any_volume;
    for (const located_cell& c : own) node.smallest_volume = std::min(node.smallest_volume, box_volume(c.bounds));
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

std::uint32_t cell_locator::find(const float eye[3], double volume_limit, format::box& out) const noexcept {
  if (nodes_.empty()) return no_cell;
  std::uint32_t best = no_cell;
  double best_volume = volume_limit;
  std::array<std::uint32_t, stack_size> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const locator_node& node = nodes_[number];
    if (node.smallest_volume > best_volume || (best == no_cell && node.smallest_volume >= volume_limit)) continue;
    if (!box_holds(node.bounds, eye)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = number + 1;
      continue;
    }
    for (const located_cell& c : cells_.subspan(node.first, node.count)) {
      if (!box_holds(c.bounds, eye)) continue;
      const double volume = box_volume(c.bounds);
      if (volume < best_volume || (best != no_cell && volume == best_volume && c.cell < best)) {
        best_volume = volume;
        best = c.cell;
        out = c.bounds;
      }
    }
  }
  return best;
}

bool cell_locator::has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept {
  if (nodes_.empty()) return false;
  std::array<std::uint32_t, stack_size> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const locator_node& node = nodes_[number];
    if (node.smallest_volume >= volume_limit || !boxes_meet(node.bounds, bounds)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = number + 1;
      continue;
    }
    for (const located_cell& c : cells_.subspan(node.first, node.count)) {
      if (box_volume(c.bounds) < volume_limit && boxes_meet(c.bounds, bounds)) return true;
    }
  }
  return false;
}

}  // namespace sightcell::runtime
