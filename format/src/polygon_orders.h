#pragma once
// The orders section (SPEC.md, "Orders"): in which order the polygons of a draw are stored. Draws share orders: all
// instances of a primitive have one. polygon_orders_writer.h is the way back.
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefix_code.h"
#include "sightcell/format/packed_columns.h"

namespace sightcell::format {

class polygon_orders {
 public:
  // bytes: the section; viewed. most: how many orders there can be, as there are draws; more could be promised by few
  // bytes. O(orders).
  polygon_orders(std::span<const std::byte> bytes, std::uint32_t most) noexcept { good_ = open(bytes, most); }
  // False when there are more, or its parts do not fit each other or the bytes; there are no orders then.
  [[nodiscard]] bool good() const noexcept { return good_; }

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  // Of all orders together.
  [[nodiscard]] std::uint32_t polygons() const noexcept { return first_polygon_[count_]; }
  // Of all orders before this one; number may be count().
  [[nodiscard]] std::uint32_t first_polygon(std::uint32_t number) const noexcept { return first_polygon_[number]; }
  [[nodiscard]] std::uint32_t polygon_count(std::uint32_t number) const noexcept {
    return first_polygon(number + 1) - first_polygon(number);
  }

  // out[i]: which of its draw's polygons, in the order of the source, is stored as the i-th. out:
  // polygon_count(number). False when the bits are none, say a polygon that there is not, or are not all that there
  // are. That none is said twice is not asked here.
  [[nodiscard]] bool source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept;

  // first_polygon() of all, for who keeps no more.
  [[nodiscard]] const packed_column& first_polygon_column() const noexcept { return first_polygon_; }

 private:
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t most) noexcept;

  bool good_ = false;
  std::uint32_t count_ = 0;
  packed_column first_polygon_, first_byte_;
  std::span<const std::byte> permutations_;
  prefix_code steps_;
};

}  // namespace sightcell::format
