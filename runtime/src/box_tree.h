#pragma once
// Place -> view cell among boxes that may overlap: the smallest volume wins, then the lowest number. A static tree of
// boxes, built once; nothing here allocates.
#include <array>
#include <cstdint>
#include <span>

#include "cell_box.h"
#include "nearest_cell.h"

namespace sightcell::runtime {

struct located_cell {
  format::box bounds;
  std::uint32_t cell = 0;
};

// By number; few cells, so that insertion is quick and takes little code.
void sort_by_number(std::span<located_cell> cells) noexcept;

// Four children side by side, so that one place is compared with all of them at once; two cache lines.
struct tree_node {
  std::array<std::array<float, 4>, 3> min{}, max{};  // by axis; min above max where there is no child
  std::array<float, 4> smallest_volume{};            // of the cells below, or a little less
  // A node, or, with how many there are in the upper 8 bits, the first of some cells.
  std::array<std::uint32_t, 4> child{};
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
  [[nodiscard]] std::uint32_t find(const rounded_point& place, double volume_limit, format::box& out) const noexcept;

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
