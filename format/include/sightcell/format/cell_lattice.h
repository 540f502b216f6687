#pragma once
// View cells on a lattice (SPEC.md, "Cells"): chunks of 8 x 8 positions of one layer, each with a bit per position that
// is a cell. The counterpart for writing is cell_lattice_writer.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// Signed numbers as columns store them: relative to the smallest one, so that numbers around 0 take few bits.
[[nodiscard]] constexpr std::uint32_t from_signed(std::int32_t value) noexcept {
  return static_cast<std::uint32_t>(value) ^ 0x80000000u;
}
[[nodiscard]] constexpr std::int32_t to_signed(std::uint32_t value) noexcept {
  return static_cast<std::int32_t>(value ^ 0x80000000u);
}

inline constexpr std::int32_t lattice_chunk_width = 8;  // positions in x and z
inline constexpr std::uint32_t max_lattice_level = 31;

// The box of the cell at a position, whose level is at most max_lattice_level. Adjacent cells share exact floats. Not
// checked by box_is_valid().
[[nodiscard]] box box_of(const lattice_shape& shape, const lattice_place& place) noexcept;

// 8 x 8 positions of one layer. Bit 8 (z mod 8) + x mod 8 of mask: there is a cell.
struct lattice_chunk {
  std::int32_t x = 0, y = 0, z = 0;  // its first position is (8 x, y, 8 z)
  std::uint32_t level = 0;
  std::uint32_t first_cell = 0;  // number of its first cell; further ones follow in the order of their bits
  std::uint64_t mask = 0;        // not 0
};

// The position of the cell of a bit of chunk.mask.
[[nodiscard]] lattice_place place_of(const lattice_chunk& chunk, unsigned bit) noexcept;

class cell_lattice {
 public:
  // A lattice without cells.
  cell_lattice() noexcept = default;

  // Opens a lattice. bytes: the lattice and nothing after it; not copied. False, and unchanged, unless it has exactly
  // `cells` cells with valid boxes, all different, in the order of SPEC.md. O(cells).
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t cells) noexcept;

  [[nodiscard]] const lattice_shape& shape() const noexcept { return shape_; }
  [[nodiscard]] std::uint32_t chunk_count() const noexcept { return chunks_; }

  // number: below chunk_count().
  [[nodiscard]] lattice_chunk chunk(std::uint32_t number) const noexcept;

  // The box of a cell. False if there is no such cell, or if the bytes changed and the box is invalid. O(log chunks).
  [[nodiscard]] bool cell_box(std::uint32_t cell, box& out) const noexcept;

 private:
  // In the order of the file.
  enum column { column_x, column_y, column_z, column_level, column_first, column_mask_low, column_mask_high, columns };

  [[nodiscard]] bool chunks_are_good(std::uint32_t cells) const noexcept;

  lattice_shape shape_;
  std::uint32_t chunks_ = 0;
  std::array<packed_column, columns> columns_;
};

}  // namespace sightcell::format
