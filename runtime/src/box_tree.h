#pragma once
// Place -> view cell among boxes that may overlap: the smallest volume wins, then the lowest number. A static tree of
// boxes, built once; nothing here allocates.
#include <cstdint>
#include <span>

#include "cell_box.h"
#include "nearest_cell.h"

namespace sightcell::runtime {

struct located_cell {
  format::box bounds;
  std::uint32_t cell = 0;
};

// One node of the tree: a leaf with count cells from first on, or (count 0) two nodes, the next one and number first.
struct tree_node {
  format::box bounds;
  double smallest_volume = 0.0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

class box_tree {
 public:
  // Nodes that build needs for so many cells.
  [[nodiscard]] static std::uint32_t node_count(std::uint32_t cells) noexcept;

  // cells: every box finite, in any order; it is reordered. nodes: node_count(cells.size()) of them. Both stay the
  // caller's and must outlive the tree. O(n log n).
  void build(std::span<located_cell> cells, std::span<tree_node> nodes) noexcept;

  // Among the cells that hold a place and are smaller than volume_limit: the smallest, then the lowest number. no_cell
  // when there is none. O(log n) where few boxes overlap; one comparison when no cell at all is smaller than
  // volume_limit. out is set only when a cell is found.
  [[nodiscard]] std::uint32_t find(const point& place, double volume_limit, format::box& out) const noexcept;

  // True when some cell smaller than volume_limit has a point in common with bounds. Where it is false, a place inside
  // bounds needs no search for a smaller cell.
  [[nodiscard]] bool has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept;

  // Writes the cells that a closed box touches, as many as dst has room for, in no order; returns how many that are, or
  // dst.size() + 1 as soon as there is no more room.
  [[nodiscard]] std::size_t touching(const wide_box& closed, std::span<located_cell> dst) const noexcept;

  // Shows the search what may be nearest. O(log n) where few boxes overlap.
  void nearest(nearest_search& search) const noexcept;

  // In the order of the tree.
  [[nodiscard]] std::span<const located_cell> cells() const noexcept { return cells_; }

 private:
  template <class Enters, class Visit>
  void walk(const Enters& enters, const Visit& visit) const noexcept;

  std::span<const located_cell> cells_;
  std::span<const tree_node> nodes_;
};

}  // namespace sightcell::runtime
