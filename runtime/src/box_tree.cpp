#include "box_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace sightcell::runtime {
namespace {

// As many cells are compared one by one.
constexpr std::uint32_t leaf_size = 4;
// A node leaves three of its children for later, and there are at most 2^24 cells: 64 is far more than a path can hold.
constexpr std::size_t stack_size = 64;
constexpr std::uint32_t first_bits = 24;
constexpr std::uint32_t first_mask = (std::uint32_t{1} << first_bits) - 1;

// Cells begin .. end - 1, in the order of the tree.
struct cell_range {
  std::uint32_t begin = 0, end = 0;
  [[nodiscard]] std::uint32_t size() const noexcept { return end - begin; }
};

// What a node's cells are parted into: halves, and these again, where they are more than a leaf.
class node_parts {
 public:
  template <class Split>
  node_parts(cell_range all, const Split& split) noexcept {
    parts_[0] = all;
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 0, now = count_; i < now; ++i) {
        cell_range& part = parts_[i];
        if (part.size() <= leaf_size) continue;
        const std::uint32_t middle = part.begin + part.size() / 2;
        split(part, middle);
        parts_[count_++] = {middle, part.end};
        part.end = middle;
      }
    }
  }
  [[nodiscard]] std::span<const cell_range> list() const noexcept { return {parts_.data(), count_}; }

 private:
  std::array<cell_range, 4> parts_;
  std::size_t count_ = 1;
};

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

// Moves the first_part cells to the front that come first along the axis on which centers lie farthest apart, then by
// number. The values between the lowest and the highest one are halved until the border lies right: each cell is looked
// at a few times, some hundred times at worst (floats have so many powers of two). Less code than std::nth_element,
// which is quadratic at worst in one library.
void split_cells(std::span<located_cell> cells, std::uint32_t first_part) noexcept {
  const std::size_t axis = split_axis(cells);
  bool by_number = false;  // where all centers are the same
  const auto value_of = [&](const located_cell& c) {
    return by_number ? static_cast<double>(c.cell) : twice_center(c, axis);
  };
  std::span<located_cell> open = cells;
  std::size_t wanted = first_part;  // of the open ones
  while (wanted > 0 && wanted < open.size()) {
    double low = value_of(open.front());
    double high = low;
    for (const located_cell& c : open) {
      low = std::min(low, value_of(c));
      high = std::max(high, value_of(c));
    }
    if (low == high) {
      if (by_number) return;
      by_number = true;
      continue;
    }
    const double half = low + 0.5 * (high - low);
    const double middle = half < high ? half : low;
    const auto comes_first = [&](const located_cell& c) { return value_of(c) <= middle; };
    const auto first = static_cast<std::size_t>(std::partition(open.begin(), open.end(), comes_first) - open.begin());
    if (wanted < first) {
      open = open.first(first);
    } else {
      open = open.subspan(first);
      wanted -= first;
    }
  }
}

// No float above the volume.
float volume_below(double volume) noexcept {
  const float near = static_cast<float>(std::min(volume, static_cast<double>(std::numeric_limits<float>::max())));
  return static_cast<double>(near) > volume ? next_below(near) : near;
}

bool is_leaf(std::uint32_t child) noexcept {
  return child > first_mask;
}

wide_box child_bounds(const tree_node& node, std::size_t i) noexcept {
  wide_box b;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    b.min[axis] = static_cast<double>(node.min[axis][i]);
    b.max[axis] = static_cast<double>(node.max[axis][i]);
  }
  return b;
}

std::span<const located_cell> cells_of(std::span<const located_cell> all, std::uint32_t child) noexcept {
  return all.subspan(child & first_mask, child >> first_bits);
}

// All parts of a number of cells are of two sizes, one apart, so few numbers are ever counted.
struct counted_nodes {
  struct entry {
    std::uint32_t cells = 0, nodes = 0;
  };
  std::array<entry, 64> known{};
  std::size_t count = 0;

  std::uint32_t of(std::uint32_t cells) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      if (known[i].cells == cells) return known[i].nodes;
    }
    std::uint32_t nodes = 1;
    const node_parts parts({0, cells}, [](const cell_range&, std::uint32_t) {});
    for (const cell_range& part : parts.list()) nodes += part.size() > leaf_size ? of(part.size()) : 0;
    if (count < known.size()) known[count++] = {cells, nodes};
    return nodes;
  }
};

}  // namespace

void sort_by_number(std::span<located_cell> cells) noexcept {
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const located_cell moved = cells[i];
    std::size_t at = i;
    for (; at > 0 && moved.cell < cells[at - 1].cell; --at) cells[at] = cells[at - 1];
    cells[at] = moved;
  }
}

std::uint32_t box_tree::node_count(std::uint32_t cells) noexcept {
  return cells == 0 ? 0 : counted_nodes{}.of(cells);
}

void box_tree::build(std::span<located_cell> cells, std::span<tree_node> nodes) noexcept {
  cells_ = cells;
  nodes_ = nodes;
  if (cells.empty()) return;
  struct task {
    cell_range range;
    std::uint32_t node = 0;
  };
  std::array<task, stack_size> stack;
  std::size_t depth = 0;
  std::uint32_t used = 1;
  stack[depth++] = {{0, static_cast<std::uint32_t>(cells.size())}, 0};
  constexpr float infinite = std::numeric_limits<float>::infinity();
  while (depth > 0) {
    const task now = stack[--depth];
    const node_parts parts(now.range, [&](const cell_range& part, std::uint32_t middle) {
      split_cells(cells.subspan(part.begin, part.size()), middle - part.begin);
    });
    tree_node& node = nodes[now.node];
    for (std::size_t i = 0; i < node.child.size(); ++i) {
      const bool there = i < parts.list().size();
      const std::span<const located_cell> own =
          there ? cells_.subspan(parts.list()[i].begin, parts.list()[i].size()) : std::span<const located_cell>();
      const format::box bounds =
          there ? bounds_of(own) : format::box{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.min[axis][i] = bounds.min[axis];
        node.max[axis][i] = bounds.max[axis];
      }
      double smallest = any_volume;
      for (const located_cell& c : own) smallest = std::min(smallest, volume_of(c.bounds));
      node.smallest_volume[i] = volume_below(smallest);
      if (!there) continue;
      if (own.size() <= leaf_size) {
        node.child[i] = static_cast<std::uint32_t>(own.size()) << first_bits | parts.list()[i].begin;
      } else {
        node.child[i] = used;
        stack[depth++] = {parts.list()[i], used++};
      }
    }
  }
}

// Calls visit(cells) for every leaf that enters(node, child) lets through on the way, until it says no.
template <class Enters, class Visit>
void box_tree::walk(const Enters& enters, const Visit& visit) const noexcept {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, stack_size> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const tree_node& node = nodes_[stack[--depth]];
    const std::array<bool, 4> entered = enters(node);
    for (std::size_t i = 0; i < entered.size(); ++i) {
      if (!entered[i]) continue;
      if (!is_leaf(node.child[i])) {
        stack[depth++] = node.child[i];
      } else if (!visit(cells_of(cells_, node.child[i]))) {
        return;
      }
    }
  }
}

std::uint32_t box_tree::find(const rounded_point& place, double volume_limit, format::box& out) const noexcept {
  std::uint32_t best = no_cell;
  double best_volume = volume_limit;
  const auto enters = [&](const tree_node& node) {
    std::array<bool, 4> entered;
    for (std::size_t i = 0; i < entered.size(); ++i) {
      // Without branches, so that all four are compared at once. Equal volumes may yet be of a lower number.
      entered[i] = (static_cast<int>(place[0] >= node.min[0][i]) & static_cast<int>(place[0] < node.max[0][i]) &
                    static_cast<int>(place[1] >= node.min[1][i]) & static_cast<int>(place[1] < node.max[1][i]) &
                    static_cast<int>(place[2] >= node.min[2][i]) & static_cast<int>(place[2] < node.max[2][i]) &
                    static_cast<int>(static_cast<double>(node.smallest_volume[i]) <= best_volume)) != 0;
    }
    return entered;
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
    std::array<bool, 4> entered;
    for (std::size_t i = 0; i < entered.size(); ++i) {
      entered[i] =
          static_cast<double>(node.smallest_volume[i]) < volume_limit && boxes_meet(child_bounds(node, i), inside);
    }
    return entered;
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
  const auto enters = [&](const tree_node& node) {
    std::array<bool, 4> entered;
    for (std::size_t i = 0; i < entered.size(); ++i) entered[i] = touches(closed, child_bounds(node, i));
    return entered;
  };
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

// The nearest child first, so that the others are mostly out of reach.
void box_tree::nearest(nearest_search& search) const noexcept {
  if (nodes_.empty()) return;
  struct near_child {
    double squared = 0.0;
    std::uint32_t child = 0;
  };
  std::array<near_child, stack_size> stack;
  std::size_t depth = 0;
  stack[depth++] = {0.0, 0};
  while (depth > 0) {
    const near_child now = stack[--depth];
    if (search.out_of_reach(now.squared)) continue;
    if (is_leaf(now.child)) {
      for (const located_cell& c : cells_of(cells_, now.child)) search.take(c.bounds, c.cell);
      continue;
    }
    const tree_node& node = nodes_[now.child];
    const std::size_t begin = depth;
    for (std::size_t i = 0; i < node.child.size(); ++i) {
      if (node.min[0][i] > node.max[0][i]) continue;
      const near_child next{search.distance_to(child_bounds(node, i)), node.child[i]};
      std::size_t at = depth++;
      for (; at > begin && stack[at - 1].squared < next.squared; --at) stack[at] = stack[at - 1];
      stack[at] = next;
    }
  }
}

}  // namespace sightcell::runtime
