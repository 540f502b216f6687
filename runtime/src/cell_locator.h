#pragma once
// Eye position -> view cell. Boxes may overlap: the smallest volume wins, then the lowest number. A static tree of
// boxes, built once; nothing here allocates.
#include <cstdint>
#include <limits>
#include <span>

#include "sightcell/format/records.h"

namespace sightcell::runtime {

inline constexpr std::uint32_t no_cell = 0xFFFFFFFFu;
inline constexpr double any_volume = std::numeric_limits<double>::infinity();

// min <= eye < max. False for NaN.
[[nodiscard]] bool box_holds(const format::box& b, const float eye[3]) noexcept;
// The same for the box grown by margin metres on every side, without rounding.
[[nodiscard]] bool grown_box_holds(const format::box& b, float margin, const float eye[3]) noexcept;
// Cubic metres. Above 0 for a valid box.
[[nodiscard]] double box_volume(const format::box& b) noexcept;

struct located_cell {
  format::box bounds;
  std::uint32_t cell = 0;
};

// One node of the tree: a leaf with count cells from first on, or (count 0) two nodes, the next one and number first.
struct locator_node {
  format::box bounds;
  double smallest_volume = 0.0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

class cell_locator {
 public:
  // Nodes that build needs for so many cells.
  [[nodiscard]] static std::uint32_t node_count(std::uint32_t cells) noexcept;

  // cells: every box finite, in any order; it is reordered. nodes: node_count(cells.size()) of them. Both stay the
  // caller's and must outlive the locator. O(n log n).
  void build(std::span<located_cell> cells, std::span<locator_node> nodes) noexcept;

  // Among the cells that hold eye and are smaller than volume_limit: the smallest, then the lowest number. no_cell when
  // there is none. O(log n) where few boxes overlap; one comparison when no cell at all is smaller than volume_limit.
  // out is set only when a cell is found.
  [[nodiscard]] std::uint32_t find(const float eye[3], double volume_limit, format::box& out) const noexcept;

  // True when some cell smaller than volume_limit has a point in common with bounds. Where it is false, a place inside
  // bounds needs no search for a smaller cell.
  [[nodiscard]] bool has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept;

 private:
  std::span<const located_cell> cells_;
  std::span<const locator_node> nodes_;
};

}  // namespace sightcell::runtime
