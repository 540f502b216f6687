#include "sightcell/format/cell_lattice.h"

#include <bit>
#include <tuple>

#include "checked_reader.h"
#include "record_rules.h"
#include "shape_reader.h"
#include "sightcell/format/grid_boxes.h"

namespace sightcell::format {
namespace {

// Whether the positions of a chunk are within the limits.
bool is_near(std::int32_t chunk) noexcept {
  constexpr std::int32_t most = (1 << 30) / lattice_chunk_width;
  return chunk >= -most && chunk < most;
}

bool comes_before(const lattice_chunk& a, const lattice_chunk& b) noexcept {
  return std::tie(a.level, a.z, a.x, a.y) < std::tie(b.level, b.z, b.x, b.y);
}

}  // namespace

lattice_place place_of(const lattice_chunk& chunk, unsigned bit) noexcept {
  constexpr auto width = static_cast<unsigned>(lattice_chunk_width);
  return {chunk.x * lattice_chunk_width + static_cast<std::int32_t>(bit % width), chunk.y,
          chunk.z * lattice_chunk_width + static_cast<std::int32_t>(bit / width), chunk.level};
}

box box_of(const lattice_shape& shape, const lattice_place& place) noexcept {
  const lattice_shape cell{shape.width_of(place.level), shape.height_of(place.level)};
  return box_of(cell, grid_box{place.x, place.y, place.z});
}

bool cell_lattice::open(std::span<const std::byte> bytes, std::uint32_t cells) noexcept {
  cell_lattice made;
  const checked_reader in(bytes);
  if (!read_shape(in, made.shape_) || !in.read_u32(shape_size, made.chunks_) || made.chunks_ > cells) return false;
  if (!open_columns(bytes.subspan(shape_size + 4), made.chunks_, made.columns_)) return false;
  if (!made.chunks_are_good(cells)) return false;
  *this = made;
  return true;
}

bool cell_lattice::chunks_are_good(std::uint32_t cells) const noexcept {
  std::uint64_t next = 0;
  lattice_chunk last;
  for (std::uint32_t number = 0; number < chunks_; ++number) {
    const lattice_chunk c = chunk(number);
    if (c.level > max_lattice_level || c.mask == 0 || c.first_cell != next) return false;
    if (!is_near(c.x) || !is_near(c.z) || c.y < -(1 << 30) || c.y >= 1 << 30) return false;
    if (number > 0 && !comes_before(last, c)) return false;
    for (std::uint64_t left = c.mask; left != 0; left &= left - 1) {
      if (!box_is_valid(box_of(shape_, place_of(c, static_cast<unsigned>(std::countr_zero(left)))))) return false;
      ++next;
    }
    last = c;
  }
  return next == cells;
}

lattice_chunk cell_lattice::chunk(std::uint32_t number) const noexcept {
  const auto value = [&](column which) { return columns_[which][number]; };
  return {to_signed(value(column_x)), to_signed(value(column_y)),
          to_signed(value(column_z)), value(column_level),
          value(column_first),        std::uint64_t{value(column_mask_high)} << 32 | value(column_mask_low)};
}

bool cell_lattice::cell_box(std::uint32_t cell, box& out) const noexcept {
  // Finds the last chunk that begins at or before the cell.
  std::uint32_t low = 0;
  std::uint32_t high = chunks_;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (columns_[column_first][middle] <= cell) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == 0) return false;
  const lattice_chunk c = chunk(low - 1);
  std::uint64_t left = c.mask;
  for (std::uint32_t before = cell - c.first_cell; before > 0 && left != 0; --before) left &= left - 1;
  if (left == 0 || c.level > max_lattice_level || !is_near(c.x) || !is_near(c.z)) return false;
  const box b = box_of(shape_, place_of(c, static_cast<unsigned>(std::countr_zero(left))));
  if (!box_is_valid(b)) return false;
  out = b;
  return true;
}

}  // namespace sightcell::format
