#pragma once
// The orders section (SPEC.md, "Orders"): the order in which the polygons of a draw are stored. Draws share orders: all
// instances of a primitive have one. The counterpart for writing is polygon_orders_writer.h.
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefix_code.h"
#include "sightcell/format/packed_columns.h"

namespace sightcell::format {

class polygon_orders {
 public:
  // bytes: the section; not copied. most: the number of draws, and so the most orders; without it, few bytes could
  // claim more. in_runs: as in a file with clusters. O(orders).
  polygon_orders(std::span<const std::byte> bytes, std::uint32_t most, bool in_runs = false) noexcept {
    good_ = open(bytes, most, in_runs);
  }
  // False if there are more orders, or if the parts contradict each other or the bytes; there are no orders then.
  [[nodiscard]] bool good() const noexcept { return good_; }

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  // Of all orders together.
  [[nodiscard]] std::uint32_t polygons() const noexcept { return first_polygon_[count_]; }
  // Of all orders before this one; number: up to count().
  [[nodiscard]] std::uint32_t first_polygon(std::uint32_t number) const noexcept { return first_polygon_[number]; }
  [[nodiscard]] std::uint32_t polygon_count(std::uint32_t number) const noexcept {
    return first_polygon(number + 1) - first_polygon(number);
  }

  // out[i]: which polygon of the draw, in source order, is stored at index i. out: polygon_count(number) elements.
  // False if the bits are invalid, name a polygon that does not exist, or are not all used. Does not test that each
  // polygon occurs once.
  [[nodiscard]] bool source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept;

  // first_polygon() of all, for callers that keep nothing else.
  [[nodiscard]] const packed_column& first_polygon_column() const noexcept { return first_polygon_; }

 private:
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t most, bool in_runs) noexcept;

  bool good_ = false;
  std::uint32_t count_ = 0;
  packed_column first_polygon_, first_byte_;
  std::span<const std::byte> permutations_;
  bool in_runs_ = false;
  prefix_code steps_, lengths_;
};

}  // namespace sightcell::format
