#pragma once
// The rules for the draws of a file together. The writer tests them before it writes, the reader after it has read.
#include <cstdint>

#include "record_rules.h"

namespace sightcell::format {

// Takes the draws of a table one after the other.
class draw_table_rules {
 public:
  draw_table_rules(host_layout layout, std::uint32_t polygon_count) noexcept
      : layout_(layout), polygon_count_(polygon_count) {}

  // order: the number of the draw's order, which has order_polygons polygons. False if the draw cannot follow those
  // before it.
  [[nodiscard]] bool take(const draw_record& d, std::uint32_t order, std::uint32_t order_polygons) noexcept {
    if (!draw_is_valid(d, layout_, order, order_polygons) || d.first_stored != stored_) return false;
    if (d.polygon_count > polygon_count_ - stored_ || d.first_source > polygon_count_ - d.polygon_count) return false;
    // Orders are numbered as draws first name them: so each belongs to a draw, and is read with it.
    if (order > orders_) return false;
    const bool named_first = order == orders_;
    if (layout_ == host_layout::merged) {
      if (named_first ? left_in_group_ != 0 : !joins_group(d)) return false;
      if (named_first) left_in_group_ = order_polygons;
      left_in_group_ -= d.polygon_count;
    }
    if (named_first) ++orders_;
    stored_ += d.polygon_count;
    last_ = d;
    return true;
  }

  // Whether these were all draws of a file with this number of orders.
  [[nodiscard]] bool complete(std::uint32_t orders) const noexcept {
    return stored_ == polygon_count_ && left_in_group_ == 0 && orders_ == orders;
  }

 private:
  // Whether the draw is after the draws of the last group in the source, has the same material, and is in the same
  // named group.
  [[nodiscard]] bool joins_group(const draw_record& d) const noexcept {
    return d.group + 1 == orders_ && d.polygon_count <= left_in_group_ &&
           d.first_source >= last_.first_source + last_.polygon_count && d.material == last_.material &&
           d.named_group == last_.named_group && ((d.flags | last_.flags) & draw_moves) == 0;
  }

  host_layout layout_;
  std::uint32_t polygon_count_;
  std::uint32_t stored_ = 0;         // polygons so far
  std::uint32_t orders_ = 0;         // orders so far, and draw groups, of which each has one
  std::uint32_t left_in_group_ = 0;  // polygons of its order that no draw has taken yet
  draw_record last_;
};

}  // namespace sightcell::format
