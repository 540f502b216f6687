#pragma once
// The rules for single values of a file. The writer tests them before it writes, the reader after it has read. Rules
// for all draws together: draw_table_rules.h.
#include <cmath>

#include "sightcell/format/layout.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// Finite, and not empty on any axis.
[[nodiscard]] inline bool box_is_valid(const box& b) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(b.min[axis]) || !std::isfinite(b.max[axis]) || !(b.min[axis] < b.max[axis])) return false;
  }
  return true;
}

[[nodiscard]] inline bool shape_is_valid(const lattice_shape& shape) noexcept {
  return std::isfinite(shape.width) && std::isfinite(shape.height) && shape.width > 0.0 && shape.height > 0.0;
}

// False for NaN too.
[[nodiscard]] inline bool is_share(double value) noexcept {
  return value >= 0.0 && value <= 1.0;
}

// Meters. False for NaN too.
[[nodiscard]] inline bool is_player_radius(float value) noexcept {
  return value > 0.0f && std::isfinite(value);
}

// whole: the region of the cell is its whole grown box, so nothing is outside.
[[nodiscard]] inline bool viewpoint_shares_are_valid(float valid, double outside, bool whole) noexcept {
  return valid > 0.0f && valid <= 1.0f && is_share(outside) && (!whole || outside == 0.0);
}

[[nodiscard]] inline bool certificate_is_valid(const certificate_record& c) noexcept {
  return c.misses <= c.rays && is_share(c.upper_bound) && is_share(c.confidence);
}

// order: the number of the draw's order, which has order_polygons polygons.
[[nodiscard]] inline bool draw_is_valid(const draw_record& d, host_layout layout, std::uint32_t order,
                                        std::uint32_t order_polygons) noexcept {
  if ((d.flags & ~draw_moves) != 0) return false;
  if (layout == host_layout::instanced) return d.group == 0 && d.polygon_count == order_polygons;
  return d.group == order && d.polygon_count <= order_polygons;
}

[[nodiscard]] inline bool facts_are_valid(const file_facts& f) noexcept {
  return f.layout <= host_layout::merged && f.margin >= 0.0f && std::isfinite(f.margin) &&
         is_share(static_cast<double>(f.max_pixel_error)) && is_share(static_cast<double>(f.confidence)) &&
         is_share(static_cast<double>(f.slack));
}

}  // namespace sightcell::format
