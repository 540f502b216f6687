#include "sightcell/format/caster_table.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <new>

#include "certificate_columns.h"
#include "checked_reader.h"
#include "code_table.h"
#include "record_rules.h"
#include "row_chunk.h"

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
  made.polygons_ = file.polygon_count();
  const checked_reader in(made.bytes_);
  if (!in.read_u32(0, made.suns_) || !in.read_u32(4, made.run_bound_) || !in.read_u32(8, made.list_bound_) ||
      made.suns_ == 0) {
    return status::corrupt;
  }
  if (made.suns_ > layout::max_suns || std::uint64_t{made.cells_} * made.suns_ > layout::max_caster_sets) {
    return status::limit;
  }
  const std::uint64_t head = layout::casters_head_size + made.suns_ * layout::sun_record_size;
  if (head > made.bytes_.size()) return status::corrupt;
  sun_record sun;
  for (std::uint32_t i = 0; i < made.suns_; ++i) {
    if (made.sun(i, sun) != status::ok || !sun_is_valid(sun)) return status::corrupt;
  }
  std::span<const std::byte> left = made.bytes_.subspan(static_cast<std::size_t>(head));
  if (!take_columns(left, made.sets(), made.certificate_) || !take_columns(left, made.chunks(), {&made.ends_, 1})) {
    return status::corrupt;
  }
  certificate_record proof;
  for (std::uint32_t set = 0; set < made.sets(); ++set) {
    const status s = made.certificate(set / made.suns_, set % made.suns_, proof);
    if (s != status::ok) return s;
  }
  made.codes_ = left;
  symbol_lengths lengths{};
  for (int i = 0; i < 6; ++i) {
    if (!read_code_lengths(left, lengths)) return status::corrupt;
  }
  made.codes_ = made.codes_.first(made.codes_.size() - left.size());
  made.rows_ = left;
  std::uint32_t end = 0;
  for (std::uint32_t chunk = 0; chunk < made.chunks(); ++chunk) {
    const std::uint32_t begin = end;
    end = made.ends_[chunk];
    if (end < begin) return status::corrupt;
  }
  if (end != made.rows_.size()) return status::corrupt;
  // A run takes two codes of a bit or more, so a small section cannot ask for large buffers.
  const std::uint64_t most_runs = 4 * static_cast<std::uint64_t>(made.rows_.size());
  if (made.run_bound_ > most_runs || made.run_bound_ > made.polygons_ || made.list_bound_ > most_runs) {
    return status::corrupt;
  }
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
  const certificate_record c = certificate_of(certificate_, cell * suns_ + sun, cell);
  if (!certificate_is_valid(c)) return status::corrupt;
  out = c;
  return status::ok;
}

std::size_t caster_table::scratch_size() const noexcept {
  return row_bounds{polygons_, run_bound_, list_bound_}.scratch_room() * sizeof(std::uint32_t);
}

status caster_table::make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept {
  out = nullptr;
  if (memory.size() < sizeof(row_codes)) return status::capacity;
  auto* codes = new (memory.data()) row_codes;
  std::span<const std::byte> left = codes_;
  for (run_code* kind : {&codes->own, &codes->removed, &codes->added}) {
    symbol_lengths gap{};
    symbol_lengths more{};
    if (!read_code_lengths(left, gap) || !read_code_lengths(left, more) || !kind->assign(gap, more)) {
      return status::corrupt;
    }
  }
  out = codes;
  return status::ok;
}

status caster_table::decode(std::uint32_t cell, std::uint32_t sun, const row_codes* codes, std::span<run> out,
                            std::span<std::byte> scratch, std::size_t& count) const noexcept {
  count = 0;
  if (cell >= cells_ || sun >= suns_ || codes == nullptr) return status::argument;
  if (out.size() < run_bound_ || scratch.size() < scratch_size()) return status::capacity;
  const std::uint32_t set = cell * suns_ + sun;
  const std::uint32_t chunk = set / layout::cells_per_block;
  const std::uint32_t first = chunk * layout::cells_per_block;
  const std::uint32_t begin = chunk == 0 ? 0 : ends_[chunk - 1];
  const std::uint32_t end = ends_[chunk];
  if (begin > end || end > rows_.size()) return status::corrupt;
  row_chunk rows;
  if (!rows.open(rows_.subspan(begin, end - begin), std::min(sets() - first, layout::cells_per_block))) {
    return status::corrupt;
  }
  const std::size_t numbers = scratch.size() / sizeof(std::uint32_t);
  auto* room = reinterpret_cast<std::uint32_t*>(scratch.data());
  std::uninitialized_default_construct_n(room, numbers);
  std::span<const std::uint32_t> borders;
  std::uint64_t row_end = 0;
  const status s =
      rows.decode(set - first, *codes, {polygons_, run_bound_, list_bound_}, {room, numbers}, borders, row_end);
  if (s != status::ok) return s;
  count = borders.size() / 2;
  for (std::size_t i = 0; i < count; ++i) out[i] = {borders[2 * i], borders[2 * i + 1] - borders[2 * i]};
  return status::ok;
}

status caster_table::check(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept {
  std::size_t most = 0;
  for (std::uint32_t set = 0; set < sets(); ++set) {
    std::size_t count = 0;
    if (const status s = decode(set / suns_, set % suns_, codes, out, scratch, count); s != status::ok) return s;
    most = std::max(most, count);
  }
  return most == run_bound_ ? status::ok : status::corrupt;
}

}  // namespace sightcell::format
