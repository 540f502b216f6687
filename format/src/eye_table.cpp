#include "sightcell/format/eye_table.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

constexpr double steps_per_side = layout::eye_steps_per_side;

// The number before value. std::nextafter would need a mathematics library.
float before(float value) noexcept {
  if (value == 0.0f) return -std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>(value > 0.0f ? bits - 1 : bits + 1);
}

}  // namespace

std::array<float, 3> eye_position(const box& cell, const eye_steps& eye) noexcept {
  std::array<float, 3> position{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto min = static_cast<double>(cell.min[axis]);
    const auto max = static_cast<double>(cell.max[axis]);
    position[axis] = static_cast<float>(min + (max - min) * ((eye[axis] + 0.5) / steps_per_side));
    // Rounding may reach the end of the box, which is outside of it.
    if (position[axis] >= cell.max[axis]) position[axis] = before(cell.max[axis]);
  }
  return position;
}

eye_steps eye_at(const box& cell, const std::array<float, 3>& position) noexcept {
  eye_steps eye{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto min = static_cast<double>(cell.min[axis]);
    const double share = (static_cast<double>(position[axis]) - min) / (static_cast<double>(cell.max[axis]) - min);
    eye[axis] = static_cast<std::uint16_t>(std::clamp(share * steps_per_side, 0.0, steps_per_side - 1.0));
  }
  return eye;
}

status eye_table::open(const reader& file, eye_table& out) noexcept {
  std::span<const std::byte> bytes;
  if (const status s = file.skipped_section(layout::section_eyes, bytes); s != status::ok) return s;
  eye_table made;
  made.cells_ = file.cell_count();
  packed_columns ends;
  std::uint64_t size = 0;
  if (!packed_columns::size_of(bytes, 1, made.cells_, size) ||
      !ends.open(bytes.first(static_cast<std::size_t>(size)), 1, made.cells_)) {
    return status::corrupt;
  }
  made.ends_ = packed_column(ends, 0);
  std::uint32_t end = 0;
  for (std::uint32_t cell = 0; cell < made.cells_; ++cell) {
    const std::uint32_t begin = end;
    end = made.ends_[cell];
    if (end < begin || end - begin > layout::max_eyes) return status::corrupt;
  }
  if (!open_columns(bytes.subspan(static_cast<std::size_t>(size)), end, made.steps_)) return status::corrupt;
  for (std::uint32_t number = 0; number < end; ++number) {
    for (const packed_column& steps : made.steps_) {
      if (steps[number] >= layout::eye_steps_per_side) return status::corrupt;
    }
  }
  out = made;
  return status::ok;
}

std::uint32_t eye_table::count(std::uint32_t cell) const noexcept {
  if (cell >= cells_) return 0;
  const std::uint32_t eyes = ends_[cell] - begin(cell);
  return eyes > layout::max_eyes ? 0 : eyes;
}

status eye_table::eye(std::uint32_t cell, std::uint32_t number, eye_steps& out) const noexcept {
  if (number >= count(cell)) return status::argument;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out[axis] = static_cast<std::uint16_t>(steps_[axis][begin(cell) + number] % layout::eye_steps_per_side);
  }
  return status::ok;
}

}  // namespace sightcell::format
