#include "sightcell/format/grid_boxes.h"

#include "checked_reader.h"
#include "shape_reader.h"
#include "sightcell/format/cell_lattice.h"

namespace sightcell::format {

box box_of(const lattice_shape& step, const grid_box& place) noexcept {
  const auto corner = [&](double more_x, double more_y, double more_z) {
    return std::array<float, 3>{static_cast<float>((place.x + more_x) * step.width),
                                static_cast<float>((place.y + more_y) * step.height),
                                static_cast<float>((place.z + more_z) * step.width)};
  };
  return {corner(0.0, 0.0, 0.0), corner(place.steps_x, place.steps_y, place.steps_z)};
}

bool grid_boxes::open(std::span<const std::byte> bytes, std::uint32_t cells) noexcept {
  grid_boxes made;
  if (!read_shape(checked_reader(bytes), made.step_)) return false;
  if (!open_columns(bytes.subspan(shape_size), cells, made.columns_)) return false;
  *this = made;
  return true;
}

grid_box grid_boxes::place(std::uint32_t cell) const noexcept {
  const auto value = [&](column which) { return columns_[which][cell]; };
  return {to_signed(value(column_x)), to_signed(value(column_y)), to_signed(value(column_z)),
          value(column_steps_x),      value(column_steps_y),      value(column_steps_z)};
}

}  // namespace sightcell::format
