#include "box_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace sightcell::runtime {
namespace {

// Up to this number of cells are tested one by one.
constexpr std::uint32_t leaf_size = 4;
// A node leaves up to three children on the stack, and there are at most 2^24 cells: no path needs 64 entries.
constexpr std::size_t stack_size = 64;
constexpr std::uint32_t first_bits = 24;
constexpr std::uint32_t first_mask = (std::uint32_t{1} << first_bits) - 1;

// Cells begin .. end - 1, in the order of the tree.
struct cell_range {
  std::uint32_t begin = 0, end = 0;
  [[nodiscard]] std::uint32_t size() const noexcept { return end - begin; }
};

// The parts into which the cells of a node are divided: two halves, and the halves of these, where they exceed a leaf.
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

// The axis along which the centers of the cells have the largest extent.
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

// Moves to the front the first_part cells that come first by center along the axis of largest extent, then by number.
// Bisects the interval of values until the border is at the wanted cell: each cell is visited a few times, or some
// hundred times in the worst case (the exponents of floats). This takes less code than std::nth_element, which is
// quadratic in the worst case in one library.
void split_cells(std::span<located_cell> cells, std::uint32_t first_part) noexcept {
  const std::size_t axis = split_axis(cells);
  bool by_number = false;  // true where all centers are equal
  const auto value_of = [&](const located_cell& c) {
    return by_number ? static_cast<double>(c.cell) : twice_center(c, axis);
  };
  std::span<located_cell> open = cells;
  std::size_t wanted = first_part;  // counted in the open cells
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

// The largest float that is not above the volume.
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

// Counts the nodes of a tree. The parts of one depth have two sizes that differ by one, so few sizes have to be
// counted.
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

// Calls visit(cells) for each leaf on a path that enters(node) accepts, until visit returns false.
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

std::uint32_t box_tree::find(const rounded_point& position, double volume_limit, format::box& out) const noexcept {
  std::uint32_t best = no_cell;
  double best_volume = volume_limit;
  const auto enters = [&](const tree_node& node) {
    std::array<bool, 4> entered;
    for (std::size_t i = 0; i < entered.size(); ++i) {
      // Without branches, so that all four are compared at once. An equal volume may belong to a lower number.
      entered[i] = (static_cast<int>(position[0] >= node.min[0][i]) & static_cast<int>(position[0] < node.max[0][i]) &
                    static_cast<int>(position[1] >= node.min[1][i]) & static_cast<int>(position[1] < node.max[1][i]) &
                    static_cast<int>(position[2] >= node.min[2][i]) & static_cast<int>(position[2] < node.max[2][i]) &
                    static_cast<int>(static_cast<double>(node.smallest_volume[i]) <= best_volume)) != 0;
    }
    return entered;
  };
  walk(enters, [&](std::span<const located_cell> cells) {
    for (const located_cell& c : cells) {
      if (!holds(c.bounds, position)) continue;
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

// Visits the nearest child first, so that most other children are out of reach.
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
