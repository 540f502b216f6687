#pragma once
// Finds the view cell of a position among boxes that may overlap: the smallest volume, then the lowest number. A static
// tree of boxes, built once; nothing here allocates.
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

// Sorts by number. Insertion sort: there are few cells, and it takes little code.
void sort_by_number(std::span<located_cell> cells) noexcept;

// Four children in one node, so that a position is compared with all of them at once. Two cache lines.
struct tree_node {
  std::array<std::array<float, 4>, 3> min{}, max{};  // by axis; min above max for a missing child
  std::array<float, 4> smallest_volume{};            // lower bound over the cells below
  // The number of a node; or a leaf: the number of cells in the upper 8 bits, their first index below.
  std::array<std::uint32_t, 4> child{};
};

class box_tree {
 public:
  // The number of nodes that build needs for this number of cells.
  [[nodiscard]] static std::uint32_t node_count(std::uint32_t cells) noexcept;

  // cells: finite boxes in any order; build reorders them. nodes: node_count(cells.size()) of them. Both belong to the
  // caller and must outlive the tree. O(n log n).
  void build(std::span<located_cell> cells, std::span<tree_node> nodes) noexcept;

  // Of the cells that contain a position and are smaller than volume_limit: the smallest, then the lowest number;
  // no_cell if there is none. O(log n) where few boxes overlap; one comparison if no cell at all is smaller than
  // volume_limit. out is set only if a cell is found.
  [[nodiscard]] std::uint32_t find(const rounded_point& position, double volume_limit, format::box& out) const noexcept;

  // True if a cell smaller than volume_limit intersects bounds. If false, a position inside bounds needs no search for
  // a smaller cell.
  [[nodiscard]] bool has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept;

  // Writes the cells that a closed box touches, up to dst.size(), in no order. Returns their number, or dst.size() + 1
  // where dst is too small.
  [[nodiscard]] std::size_t touching(const wide_box& closed, std::span<located_cell> dst) const noexcept;

  // Passes the cells that may be nearest to the search. O(log n) where few boxes overlap.
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
