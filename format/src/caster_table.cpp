#include "sightcell/format/caster_table.h"

#include "checked_reader.h"

namespace sightcell::format {
namespace {

bool sun_is_valid(const sun_record& sun) noexcept {
  const auto is_unit = [](const std::array<float, 3>& v) {
    const float square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return square > 0.99f && square < 1.01f;  // false for NaN too
  };
  const float along = sun.from[0] * sun.to[0] + sun.from[1] * sun.to[1] + sun.from[2] * sun.to[2];
  return is_unit(sun.from) && is_unit(sun.to) && along > -0.01f;
}

}  // namespace

status caster_table::open(const reader& file, caster_table& out) noexcept {
  caster_table made;
  if (const status s = file.skipped_section(layout::section_casters, made.bytes_); s != status::ok) return s;
  made.cells_ = file.cell_count();
  extra_sets::shape shape{.polygons = file.polygon_count()};
  const checked_reader in(made.bytes_);
  if (!in.read_u32(0, made.suns_) || !in.read_u32(4, shape.run_bound) || !in.read_u32(8, shape.list_bound) ||
      made.suns_ == 0) {
    return status::corrupt;
  }
  if (made.suns_ > layout::max_suns || std::uint64_t{made.cells_} * made.suns_ > layout::max_caster_sets) {
    return status::limit;
  }
  shape.count = made.cells_ * made.suns_;
  const std::uint64_t head = layout::casters_head_size + made.suns_ * layout::sun_record_size;
  if (head > made.bytes_.size()) return status::corrupt;
  sun_record sun;
  for (std::uint32_t i = 0; i < made.suns_; ++i) {
    if (made.sun(i, sun) != status::ok || !sun_is_valid(sun)) return status::corrupt;
  }
  const status s = extra_sets::open(made.bytes_.subspan(static_cast<std::size_t>(head)), shape, made.sets_);
  if (s != status::ok) return s;
  out = made;
  return status::ok;
}

status caster_table::sun(std::uint32_t number, sun_record& out) const noexcept {
  if (number >= suns_) return status::argument;
  const checked_reader in(bytes_);
  const std::uint64_t at = layout::casters_head_size + number * layout::sun_record_size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!in.read_f32(at + 4 * axis, out.from[axis]) || !in.read_f32(at + 12 + 4 * axis, out.to[axis])) {
      return status::corrupt;
    }
  }
  return status::ok;
}

status caster_table::certificate(std::uint32_t cell, std::uint32_t sun, certificate_record& out) const noexcept {
  if (cell >= cells_ || sun >= suns_) return status::argument;
  return sets_.certificate(cell * suns_ + sun, cell, out);
}

status caster_table::decode(std::uint32_t cell, std::uint32_t sun, const row_codes* codes, std::span<run> out,
                            std::span<std::byte> scratch, std::size_t& count) const noexcept {
  count = 0;
  if (cell >= cells_ || sun >= suns_) return status::argument;
  return sets_.decode(cell * suns_ + sun, codes, out, scratch, count);
}

}  // namespace sightcell::format
