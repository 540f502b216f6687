#include "sightcell/format/reader.h"

#include <algorithm>
#include <array>

#include "checked_reader.h"
#include "checksum.h"
#include "record_rules.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {

std::span<const std::byte> reader::part(extent where) const noexcept {
  return bytes_.subspan(static_cast<std::size_t>(where.offset), static_cast<std::size_t>(where.size));
}

status reader::open(std::span<const std::byte> bytes, reader& out) noexcept {
  reader file;
  file.bytes_ = bytes;
  if (const status s = file.read_header(); s != status::ok) return s;
  if (const status s = file.read_sections(); s != status::ok) return s;
  if (const status s = file.check_sizes(); s != status::ok) return s;
  if (const status s = file.check_draws(); s != status::ok) return s;
  if (const status s = file.check_cells(); s != status::ok) return s;
  if (const status s = file.check_directory(); s != status::ok) return s;
  if (const status s = file.check_certificate(); s != status::ok) return s;
  out = file;
  return status::ok;
}

// Magic and version come before the checksum, since a later version may place it elsewhere.
status reader::read_header() noexcept {
  const checked_reader in(bytes_);
  for (std::size_t i = 0; i < layout::magic.size(); ++i) {
    std::uint8_t byte = 0;
    if (!in.read_u8(i, byte)) return status::truncated;
    if (byte != layout::magic[i]) return status::not_ours;
  }
  if (!in.read_u32(layout::header_version, version_)) return status::truncated;
  if (version_ != layout::version) return status::version;
  if (bytes_.size() < layout::header_size) return status::truncated;

  std::uint32_t stored_checksum = 0;
  std::uint64_t total = 0;
  std::uint64_t reserved = 0;
  std::uint32_t layout_number = 0;
  std::uint32_t flags = 0;
  bool read = in.read_u32(layout::header_checksum, stored_checksum);
  if (!read || crc32c(bytes_.first(layout::header_checksum)) != stored_checksum) return status::checksum;
  read = in.read_u32(layout::header_section_count, section_count_) && in.read_u64(layout::header_total_size, total) &&
         in.read_u32(layout::header_polygon_count, facts_.polygon_count) &&
         in.read_u32(layout::header_layout, layout_number) && in.read_f32(layout::header_margin, facts_.margin) &&
         in.read_f32(layout::header_max_pixel_error, facts_.max_pixel_error) &&
         in.read_f32(layout::header_confidence, facts_.confidence) && in.read_u32(layout::header_flags, flags) &&
         in.read_u32(layout::header_cell_count, cell_count_) && in.read_u32(layout::header_draw_count, draw_count_) &&
         in.read_u32(layout::header_run_bound, run_bound_) && in.read_u32(layout::header_range_bound, range_bound_) &&
         in.read_u64(layout::header_reserved, reserved);
  for (std::size_t i = 0; i < facts_.scene_fingerprint.size(); ++i) {
    read = in.read_u8(layout::header_fingerprint + i, facts_.scene_fingerprint[i]) && read;
  }
  if (!read || total < bytes_.size()) return status::corrupt;
  if (total > bytes_.size()) return status::truncated;
  facts_.layout = static_cast<host_layout>(layout_number);
  facts_.repeatable = (flags & layout::flag_not_repeatable) == 0;
  if (!facts_are_valid(facts_) || (flags & ~layout::flag_not_repeatable) != 0 || reserved != 0) return status::corrupt;
  if (facts_.polygon_count > layout::max_polygons || cell_count_ > layout::max_cells ||
      draw_count_ > layout::max_draws || section_count_ > layout::max_sections || facts_.margin > layout::max_margin) {
    return status::limit;
  }
  return status::ok;
}

// Sections follow each other without gap or overlap from the end of the table to the end of the file, so every byte is
// under some checksum.
status reader::read_sections() noexcept {
  const std::uint64_t table_size = section_count_ * layout::section_record_size;
  if (table_size > bytes_.size() - layout::header_size) return status::corrupt;
  std::uint32_t stored_checksum = 0;
  if (!checked_reader(bytes_).read_u32(layout::header_table_checksum, stored_checksum)) return status::corrupt;
  if (crc32c(part({layout::header_size, table_size})) != stored_checksum) return status::checksum;

  const std::array<std::uint32_t, 6> ids{layout::section_draws,       layout::section_cells,
                                         layout::section_rows,        layout::section_row_directory,
                                         layout::section_certificate, layout::section_settings};
  const std::array<extent*, 6> places{&draws_, &cells_, &rows_, &directory_, &certificate_, &settings_};
  std::array<bool, 6> found{};
  std::uint64_t next = layout::header_size + table_size;
  for (std::uint32_t i = 0; i < section_count_; ++i) {
    section_record entry;
    if (const status s = section(i, entry); s != status::ok) return s;
    if (entry.offset != next || entry.size > bytes_.size() - next) return status::corrupt;
    next += entry.size;
    const auto known = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), entry.id) - ids.begin());
    if (known == ids.size()) {
      if (entry.required) return status::version;
      continue;
    }
    const bool must = entry.id != layout::section_certificate && entry.id != layout::section_settings;
    if (found[known] || entry.required != must) return status::corrupt;
    found[known] = true;
    *places[known] = {entry.offset, entry.size};
    if (entry.id == layout::section_certificate) certificate_count_ = cell_count_;
    if (entry.id != layout::section_rows) {
      if (const status s = check_section(i); s != status::ok) return s;
    }
  }
  if (next != bytes_.size() || !(found[0] && found[1] && found[2] && found[3])) return status::corrupt;
  return status::ok;
}

status reader::section(std::uint32_t number, section_record& out) const noexcept {
  if (number >= section_count_) return status::argument;
  const checked_reader in(bytes_);
  const std::uint64_t at = layout::header_size + number * layout::section_record_size;
  std::uint32_t flags = 0;
  std::uint32_t reserved = 0;
  section_record entry;
  if (!in.read_u32(at, entry.id) || !in.read_u32(at + 4, flags) || !in.read_u64(at + 8, entry.offset) ||
      !in.read_u64(at + 16, entry.size) || !in.read_u32(at + 28, reserved)) {
    return status::corrupt;
  }
  if ((flags & ~layout::section_required) != 0 || reserved != 0) return status::corrupt;
  if (entry.offset > bytes_.size() || entry.size > bytes_.size() - entry.offset) return status::corrupt;
  entry.required = (flags & layout::section_required) != 0;
  out = entry;
  return status::ok;
}

status reader::check_section(std::uint32_t number) const noexcept {
  section_record entry;
  if (const status s = section(number, entry); s != status::ok) return s;
  std::uint32_t stored = 0;
  const std::uint64_t at = layout::header_size + number * layout::section_record_size;
  if (!checked_reader(bytes_).read_u32(at + 24, stored)) return status::corrupt;
  return crc32c(part({entry.offset, entry.size})) == stored ? status::ok : status::checksum;
}

status reader::check_sizes() noexcept {
  if (draws_.size != draw_count_ * layout::draw_record_size || cells_.size != cell_count_ * layout::cell_record_size ||
      directory_.size != chunk_count() * layout::chunk_record_size + cell_count_ * layout::row_record_size ||
      certificate_.size != certificate_count_ * layout::certificate_record_size) {
    return status::corrupt;
  }
  if (settings_.size > layout::max_settings_size) return status::limit;
  // A run takes two bytes of rows at least, and a range is a run or a draw border inside a run: so a small file cannot
  // ask a host for large buffers.
  if (run_bound_ > rows_.size / 2 || run_bound_ > facts_.polygon_count) return status::corrupt;
  if (range_bound_ < run_bound_ || range_bound_ > std::uint64_t{run_bound_} + draw_count_) return status::corrupt;
  if (run_bound_ == 0 && range_bound_ != 0) return status::corrupt;
  return status::ok;
}

status reader::draw(std::uint32_t number, draw_record& out) const noexcept {
  if (number >= draw_count_) return status::argument;
  const checked_reader in(part(draws_));
  const std::uint64_t at = number * layout::draw_record_size;
  draw_record d;
  if (!in.read_u32(at, d.node) || !in.read_u32(at + 4, d.mesh) || !in.read_u32(at + 8, d.primitive) ||
      !in.read_u32(at + 12, d.instance) || !in.read_u32(at + 16, d.material) || !in.read_u32(at + 20, d.group) ||
      !in.read_u32(at + 24, d.first_source) || !in.read_u32(at + 28, d.polygon_count) ||
      !in.read_u32(at + 32, d.first_stored) || !in.read_u32(at + 36, d.base_vertex) ||
      !in.read_u64(at + 40, d.host_tag)) {
    return status::corrupt;
  }
  // Version 0: instanced, stored order is source order.
  if (std::uint64_t{d.first_stored} + d.polygon_count > facts_.polygon_count || d.first_source != d.first_stored ||
      d.group != 0) {
    return status::corrupt;
  }
  out = d;
  return status::ok;
}

status reader::check_draws() const noexcept {
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < draw_count_; ++i) {
    draw_record d;
    if (const status s = draw(i, d); s != status::ok) return s;
    if (d.first_stored != next) return status::corrupt;
    next += d.polygon_count;  // draw() keeps this inside polygon_count
  }
  return next == facts_.polygon_count ? status::ok : status::corrupt;
}

status reader::cell_box(std::uint32_t cell, box& out) const noexcept {
  if (cell >= cell_count_) return status::argument;
  const checked_reader in(part(cells_));
  const std::uint64_t at = cell * layout::cell_record_size;
  box b;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!in.read_f32(at + 4 * axis, b.min[axis]) || !in.read_f32(at + 12 + 4 * axis, b.max[axis])) {
      return status::corrupt;
    }
  }
  if (!box_is_valid(b)) return status::corrupt;
  out = b;
  return status::ok;
}

status reader::check_cells() const noexcept {
  box b;
  for (std::uint32_t i = 0; i < cell_count_; ++i) {
    if (const status s = cell_box(i, b); s != status::ok) return s;
  }
  return status::ok;
}

std::string_view reader::settings() const noexcept {
  const std::span<const std::byte> text = part(settings_);
  return {reinterpret_cast<const char*>(text.data()), text.size()};
}

status reader::certificate(std::uint32_t number, certificate_record& out) const noexcept {
  if (number >= certificate_count_) return status::argument;
  const checked_reader in(part(certificate_));
  const std::uint64_t at = number * layout::certificate_record_size;
  certificate_record c;
  c.cell = number;
  if (!in.read_u64(at, c.rays) || !in.read_u64(at + 8, c.misses) || !in.read_f64(at + 16, c.upper_bound) ||
      !in.read_f64(at + 24, c.confidence) || !in.read_u64(at + 32, c.seed)) {
    return status::corrupt;
  }
  if (!certificate_is_valid(c)) return status::corrupt;
  out = c;
  return status::ok;
}

status reader::check_certificate() const noexcept {
  certificate_record c;
  for (std::uint32_t i = 0; i < certificate_count_; ++i) {
    if (const status s = certificate(i, c); s != status::ok) return s;
  }
  return status::ok;
}

}  // namespace sightcell::format
