#pragma once
// Finds the view cell of a position where cells are on a lattice (SPEC.md, "Cells"): a hash table of chunks of 8 x 8
// cells, 24 bytes each at half load, so 0.75 bytes per cell where chunks are full. Built once; nothing here allocates.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "box_tree.h"
#include "cell_box.h"
#include "nearest_cell.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/chunk_borders.h"

namespace sightcell::runtime {

using format::count_bits;

// An entry of the table. An empty slot has mask 0.
struct lattice_slot {
  std::uint64_t mask = 0;
  std::int32_t x = 0, y = 0, z = 0;
  std::uint32_t level_and_first = 0;  // level in the upper 8 bits, number of its first cell below

  [[nodiscard]] std::uint32_t level() const noexcept { return level_and_first >> 24; }
  [[nodiscard]] std::uint32_t first_cell() const noexcept { return level_and_first & 0xFFFFFFu; }
};

class lattice_index {
 public:
  // The number of slots that build needs for this number of chunks.
  [[nodiscard]] static std::uint64_t slot_count(std::uint32_t chunks) noexcept { return std::uint64_t{2} * chunks; }

  // slots: slot_count(lattice.chunk_count()) empty slots; they belong to the caller and must outlive the index. False
  // if the bytes changed since they were opened, or if the cells were chosen to collide in the table.
  [[nodiscard]] bool build(const format::cell_lattice& lattice, std::uint32_t cells,
                           std::span<lattice_slot> slots) noexcept;

  // As in box_tree. find takes one probe for each level that has cells.
  [[nodiscard]] std::uint32_t find(const rounded_point& position, double volume_limit, format::box& out) const noexcept;
  // May return true without reason where levels are far apart, or far from the origin.
  [[nodiscard]] bool has_smaller_inside(const format::box& bounds, double volume_limit) const noexcept;
  [[nodiscard]] std::size_t touching(const wide_box& closed, std::span<located_cell> dst) const noexcept;
  // O(chunks), with little work for each.
  void nearest(nearest_search& search) const noexcept;

  // The whole table, with empty slots.
  [[nodiscard]] std::span<const lattice_slot> slots() const noexcept { return slots_; }
  // The box around all positions of a chunk, with or without a cell.
  [[nodiscard]] wide_box bounds_of(const lattice_slot& chunk) const noexcept;
  [[nodiscard]] format::box box_of(const lattice_slot& chunk, unsigned bit) const noexcept;

 private:
  struct level_shape {
    std::uint32_t level = 0;
    double width = 0.0, height = 0.0;          // meters
    double per_width = 0.0, per_height = 0.0;  // their reciprocals
  };

  template <class Test>
  [[nodiscard]] std::size_t touching_level(const level_shape& level, const wide_box& within, const Test& test,
                                           std::span<located_cell> dst, std::size_t found) const noexcept;
  [[nodiscard]] const lattice_slot* chunk_at(std::int32_t x, std::int32_t y, std::int32_t z,
                                             std::uint32_t level) const noexcept;
  [[nodiscard]] std::uint64_t slot_of(std::int32_t x, std::int32_t y, std::int32_t z,
                                      std::uint32_t level) const noexcept;
  [[nodiscard]] bool insert(const lattice_slot& chunk) noexcept;
  [[nodiscard]] std::span<const level_shape> levels() const noexcept { return {levels_.data(), level_count_}; }

  format::lattice_shape shape_;
  std::span<lattice_slot> slots_;
  // The levels that have cells, finest first.
  std::array<level_shape, format::max_lattice_level + 1> levels_;
  std::size_t level_count_ = 0;
  // The rounding of borders is small compared with a cell, so that a coarser cell never has the smaller volume.
  bool finer_is_smaller_ = true;
};

}  // namespace sightcell::runtime
