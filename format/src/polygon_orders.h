#pragma once
// The orders section (SPEC.md, "Orders"): in which order the polygons of a draw are stored. Draws share orders: all
// instances of a primitive have one. polygon_orders_writer.h is the way back.
#include <cstddef>
#include <cstdint>
#include <span>

#include "packed_columns.h"
#include "prefix_code.h"

namespace sightcell::format {

class polygon_orders {
 public:
  // A section without orders.
  polygon_orders() noexcept = default;
  // bytes: the section; viewed. False when its parts do not fit each other or the bytes. O(orders).
  [[nodiscard]] bool open(std::span<const std::byte> bytes) noexcept;

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  // Of all orders together.
  [[nodiscard]] std::uint32_t polygons() const noexcept { return first_polygon_[count_]; }
  // Of all orders before this one; number may be count().
  [[nodiscard]] std::uint32_t first_polygon(std::uint32_t number) const noexcept { return first_polygon_[number]; }
  [[nodiscard]] std::uint32_t polygon_count(std::uint32_t number) const noexcept {
    return first_polygon(number + 1) - first_polygon(number);
  }

  // out[i]: which of its draw's polygons, in the order of the source, is stored as the i-th. out:
  // polygon_count(number). False when the bits are none, or say a polygon that there is not. That none is said twice is
  // not asked here.
  [[nodiscard]] bool source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept;

 private:
  std::uint32_t count_ = 0;
  packed_column first_polygon_, first_byte_;
  std::span<const std::byte> permutations_;
  prefix_code steps_;
};

}  // namespace sightcell::format
