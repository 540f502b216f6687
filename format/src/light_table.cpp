#include "sightcell/format/light_table.h"

#include <cmath>

#include "checked_reader.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

bool light_is_valid(const light_record& light) noexcept {
  float square = 0.0f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(light.position[axis])) return false;
    square += light.direction[axis] * light.direction[axis];
  }
  // False for NaN too.
  return square > 0.99f && square < 1.01f && light.range > 0.0f && light.cone >= 0.0f &&
         light.cone <= layout::widest_cone;
}

}  // namespace

status light_table::open(const reader& file, light_table& out) noexcept {
  light_table made;
  if (const status s = file.skipped_section(layout::section_lights, made.bytes_); s != status::ok) return s;
  made.cells_ = file.cell_count();
  extra_sets::shape shape{.polygons = file.polygon_count()};
  const checked_reader in(made.bytes_);
  if (!in.read_u32(0, made.lights_) || !in.read_u32(4, shape.run_bound) || !in.read_u32(8, shape.list_bound) ||
      made.lights_ == 0) {
    return status::corrupt;
  }
  if (made.lights_ > layout::max_lights) return status::limit;
  shape.count = made.lights_;
  const std::uint64_t head = layout::lights_head_size + made.lights_ * layout::light_record_size;
  const std::uint64_t bytes_of_cell = (made.lights_ + 7) / 8;
  const std::uint64_t sets_begin = head + made.cells_ * bytes_of_cell;
  if (sets_begin > made.bytes_.size()) return status::corrupt;
  light_record light;
  for (std::uint32_t i = 0; i < made.lights_; ++i) {
    if (made.light(i, light) != status::ok || !light_is_valid(light)) return status::corrupt;
  }
  made.touching_ = made.bytes_.subspan(static_cast<std::size_t>(head), static_cast<std::size_t>(sets_begin - head));
  const checked_reader touching(made.touching_);
  const unsigned fill = made.lights_ % 8 == 0 ? 0u : 0xFFu << (made.lights_ % 8) & 0xFFu;
  std::uint8_t last = 0;
  for (std::uint32_t cell = 0; cell < made.cells_; ++cell) {
    if (!touching.read_u8((cell + 1) * bytes_of_cell - 1, last) || (last & fill) != 0) return status::corrupt;
  }
  const status s = extra_sets::open(made.bytes_.subspan(static_cast<std::size_t>(sets_begin)), shape, made.sets_);
  if (s != status::ok) return s;
  out = made;
  return status::ok;
}

status light_table::light(std::uint32_t number, light_record& out) const noexcept {
  if (number >= lights_) return status::argument;
  const checked_reader in(bytes_);
  const std::uint64_t at = layout::lights_head_size + number * layout::light_record_size;
  light_record made;
  bool read = in.read_u32(at, made.node);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    read = read && in.read_f32(at + 4 + 4 * axis, made.position[axis]) &&
           in.read_f32(at + 16 + 4 * axis, made.direction[axis]);
  }
  if (!read || !in.read_f32(at + 28, made.range) || !in.read_f32(at + 32, made.cone)) return status::corrupt;
  out = made;
  return status::ok;
}

bool light_table::touches(std::uint32_t cell, std::uint32_t light) const noexcept {
  if (cell >= cells_ || light >= lights_) return false;
  const std::uint64_t bytes_of_cell = (lights_ + 7) / 8;
  std::uint8_t eight = 0;
  return checked_reader(touching_).read_u8(cell * bytes_of_cell + light / 8, eight) && (eight >> (light % 8) & 1u) != 0;
}

}  // namespace sightcell::format
