#include "sightcell/format/reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "certificate_columns.h"
#include "checked_reader.h"
#include "checksum.h"
#include "draw_table_rules.h"
#include "polygon_orders.h"
#include "record_rules.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

}  // namespace

// Empty for parts after the front, if the reader has only the front.
std::span<const std::byte> reader::part(extent where) const noexcept {
  if (where.offset > bytes_.size() || where.size > bytes_.size() - where.offset) return {};
  return bytes_.subspan(static_cast<std::size_t>(where.offset), static_cast<std::size_t>(where.size));
}

status reader::open(std::span<const std::byte> bytes, reader& out) noexcept {
  reader file;
  file.bytes_ = bytes;
  file.total_size_ = bytes.size();
  if (const status s = file.open_all(); s != status::ok) return s;
  out = file;
  return status::ok;
}

status reader::open_front(std::span<const std::byte> front, std::uint64_t total_size, reader& out) noexcept {
  reader file;
  file.bytes_ = front;
  file.total_size_ = total_size;
  if (const status s = file.open_all(); s != status::ok) return s;
  if (file.is_v0()) return status::version;
  out = file;
  return status::ok;
}

status reader::front_size(std::span<const std::byte> begin, std::uint64_t total_size, std::uint64_t& out) noexcept {
  reader file;
  file.bytes_ = begin;
  file.total_size_ = total_size;
  if (const status s = file.read_header(); s != status::ok) return s;
  const std::uint64_t table_end = layout::header_size + file.section_count_ * layout::section_record_size;
  if (table_end > begin.size()) return status::corrupt;
  std::uint64_t end = table_end;
  for (std::uint32_t i = 0; i < file.section_count_; ++i) {
    section_record entry;
    if (const status s = file.section(i, entry); s != status::ok) return s;
    if (layout::is_bulk(entry.id)) continue;
    end = std::max(end, entry.offset + entry.size);
  }
  out = end;
  return status::ok;
}

status reader::open_all() noexcept {
  if (const status s = read_header(); s != status::ok) return s;
  if (const status s = read_sections(); s != status::ok) return s;
  if (const status s = check_sizes(); s != status::ok) return s;
  if (const status s = open_tables(); s != status::ok) return s;
  if (const status s = check_bounds(); s != status::ok) return s;
  if (const status s = check_draws(); s != status::ok) return s;
  if (const status s = check_cells(); s != status::ok) return s;
  if (const status s = check_directory(); s != status::ok) return s;
  return check_certificate();
}

// Magic and version come before the checksum, since a later version may have it elsewhere.
status reader::read_header() noexcept {
  const checked_reader in(bytes_);
  for (std::size_t i = 0; i < layout::magic.size(); ++i) {
    std::uint8_t byte = 0;
    if (!in.read_u8(i, byte)) return status::truncated;
    if (byte != layout::magic[i]) return status::not_ours;
  }
  if (!in.read_u32(layout::header_version, version_)) return status::truncated;
  if (version_ > layout::version || version_ < layout::oldest_version) return status::version;
  if (bytes_.size() < layout::header_size) return status::truncated;

  std::uint32_t stored_checksum = 0;
  std::uint64_t total = 0;
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
         in.read_u32(layout::header_list_bound, list_bound_) && in.read_f32(layout::header_slack, facts_.slack);
  for (std::size_t i = 0; i < facts_.scene_fingerprint.size(); ++i) {
    read = in.read_u8(layout::header_fingerprint + i, facts_.scene_fingerprint[i]) && read;
  }
  if (!read || total < total_size_) return status::corrupt;
  if (total > total_size_) return status::truncated;
  facts_.layout = static_cast<host_layout>(layout_number);
  facts_.repeatable = (flags & layout::flag_not_repeatable) == 0;
  if (!facts_are_valid(facts_) || (flags & ~layout::flag_not_repeatable) != 0) return status::corrupt;
  const bool later = list_bound_ != 0 || facts_.slack != 0.0f || facts_.layout != host_layout::instanced;
  if (is_v0() && later) return status::corrupt;
  if (facts_.polygon_count > layout::max_polygons || cell_count_ > layout::max_cells ||
      draw_count_ > layout::max_draws || section_count_ > layout::max_sections || facts_.margin > layout::max_margin) {
    return status::limit;
  }
  return status::ok;
}

// Sections follow each other without gap or overlap from the end of the table to the end of the file, so each byte has
// a checksum.
status reader::read_sections() noexcept {
  const std::uint64_t table_size = section_count_ * layout::section_record_size;
  if (table_size > bytes_.size() - layout::header_size) return status::corrupt;
  std::uint32_t stored_checksum = 0;
  if (!checked_reader(bytes_).read_u32(layout::header_table_checksum, stored_checksum)) return status::corrupt;
  if (crc32c(part({layout::header_size, table_size})) != stored_checksum) return status::checksum;

  const std::array<std::uint32_t, 14> ids{
      layout::section_draws,         layout::section_cells,        layout::section_rows,
      layout::section_row_directory, layout::section_certificate,  layout::section_settings,
      layout::section_orders,        layout::section_codes,        layout::section_importance,
      layout::section_volumes,       layout::section_named_groups, layout::section_viewpoints,
      layout::section_borders,       layout::section_clusters};
  const std::array<extent*, 14> places{
      &draws_, &cells_,      &rows_,         &directory_,         &certificate_,     &settings_,     &orders_,
      &codes_, &importance_, &volume_bytes_, &named_group_bytes_, &viewpoint_bytes_, &border_bytes_, &cluster_bytes_};
  std::array<bool, 14> found{};
  const std::size_t known_ids = is_v0() ? 6 : ids.size() - (layout::reads_clusters ? 0 : 1);
  std::uint64_t next = layout::header_size + table_size;
  for (std::uint32_t i = 0; i < section_count_; ++i) {
    section_record entry;
    if (const status s = section(i, entry); s != status::ok) return s;
    if (entry.offset != next || entry.size > total_size_ - next) return status::corrupt;
    next += entry.size;
    std::size_t known = 0;
    while (known < known_ids && ids[known] != entry.id) ++known;
    // As readers did before these sections existed: they are never required.
    const bool added = entry.id == layout::section_importance || entry.id == layout::section_named_groups ||
                       entry.id == layout::section_viewpoints;
    if (known == known_ids || added) {
      if (entry.required) return status::version;
      if (known == known_ids) continue;
    }
    const bool must = !added && entry.id != layout::section_certificate && entry.id != layout::section_settings;
    if (found[known] || entry.required != must) return status::corrupt;
    found[known] = true;
    *places[known] = {entry.offset, entry.size};
    if (entry.id == layout::section_certificate) certificate_count_ = cell_count_;
    if (!layout::is_bulk(entry.id)) {
      if (const status s = check_section(i); s != status::ok) return s;
    }
  }
  const bool complete = found[0] && found[1] && found[2] && found[3] && (is_v0() || (found[6] && found[7]));
  has_importance_ = found[8];
  has_volumes_ = found[9];
  has_named_groups_ = found[10];
  has_viewpoints_ = found[11];
  has_borders_ = found[12];
  has_clusters_ = layout::reads_clusters && found[13];
  return next == total_size_ && complete ? status::ok : status::corrupt;
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
  if (entry.offset > total_size_ || entry.size > total_size_ - entry.offset) return status::corrupt;
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

status reader::skipped_section(std::uint32_t id, std::span<const std::byte>& out) const noexcept {
  bool found = false;
  for (std::uint32_t i = 0; i < section_count_ && !is_v0(); ++i) {
    section_record entry;
    if (const status s = section(i, entry); s != status::ok) return s;
    if (entry.id != id) continue;
    if (found) return status::corrupt;
    if (const status s = check_section(i); s != status::ok) return s;
    found = true;
    out = part({entry.offset, entry.size});
  }
  return found ? status::ok : status::absent;
}

status reader::check_sizes() noexcept {
  chunks_ = chunk_borders(cell_count_);
  if (has_borders_ && !chunks_.open(part(border_bytes_), cell_count_)) return status::corrupt;
  const std::uint64_t directory = chunk_count() * layout::chunk_record_size;
  if (is_v0()) {
    if (draws_.size != draw_count_ * layout::v0_draw_record_size ||
        cells_.size != cell_count_ * layout::cell_record_size ||
        directory_.size != directory + cell_count_ * layout::v0_row_record_size ||
        certificate_.size != certificate_count_ * layout::v0_certificate_record_size) {
      return status::corrupt;
    }
  } else if (directory_.size != directory) {
    return status::corrupt;
  }
  return settings_.size > layout::max_settings_size ? status::limit : status::ok;
}

// Volumes count as one more draw after the last.
status reader::check_bounds() const noexcept {
  // A run takes two codes of a bit or more (two bytes in version 0), and a range is a run or a draw border inside a
  // run: so a small file cannot ask a host for large buffers.
  const std::uint64_t most_runs = is_v0() ? rows_.size / 2 : 4 * rows_.size;
  if (run_bound_ > most_runs || run_bound_ > item_count() || list_bound_ > most_runs) return status::corrupt;
  const std::uint64_t most_ranges = std::uint64_t{run_bound_} + draw_count_ + (has_volumes_ ? 1 : 0);
  if (range_bound_ < run_bound_ || range_bound_ > most_ranges) return status::corrupt;
  if (run_bound_ == 0 && range_bound_ != 0) return status::corrupt;
  return status::ok;
}

// The packed tables of version 1.
status reader::open_tables() noexcept {
  if (is_v0()) {
    order_count_ = draw_count_;
    return status::ok;
  }
  // Draws with polygons differ, so each takes a bit: else few bytes could claim millions.
  if (draw_count_ > 8 * draws_.size || !open_columns(part(draws_), draw_count_, draw_columns_)) return status::corrupt;
  const std::span<packed_column> certificate_columns(certificate_columns_);
  if (!open_columns(part(certificate_), certificate_count_,
                    certificate_columns.first(certificate_count_ == 0 ? 0 : layout::certificate_columns))) {
    return status::corrupt;
  }

  const polygon_orders orders(part(orders_), draw_count_, layout::reads_clusters && has_clusters_);
  if (!orders.good()) return status::corrupt;
  order_count_ = orders.count();
  order_begin_ = orders.first_polygon_column();
  if (layout::reads_clusters && has_clusters_) {
    if (const status s = open_clusters(); s != status::ok) return s;
  }

  if (has_volumes_) {
    const status s = volume_table::open(part(volume_bytes_), facts_.polygon_count, volumes_);
    if (s != status::ok) return s;
  }
  if (has_named_groups_) {
    const status s = named_group_table::open(part(named_group_bytes_), draw_count_, named_groups_);
    if (s != status::ok) return s;
  }
  if (has_viewpoints_) {
    const status s = viewpoint_table::open(part(viewpoint_bytes_), cell_count_, viewpoints_);
    if (s != status::ok) return s;
  }
  std::uint32_t kind = 0;
  if (!checked_reader(part(cells_)).read_u32(0, kind)) return status::corrupt;
  const std::span<const std::byte> cells = part(cells_).subspan(4);
  cell_kind_ = kind;
  bool good = false;
  switch (kind) {
    case layout::cells_are_boxes:
      good = cells.size() == cell_count_ * layout::cell_record_size;
      break;
    case layout::cells_are_on_lattice:
      good = lattice_.open(cells, cell_count_);
      break;
    case layout::cells_are_on_grid:
      good = grid_.open(cells, cell_count_);
      break;
    default:
      break;
  }
  return good ? status::ok : status::corrupt;
}

// The clusters of the whole file are those of its range units. Draws are checked later.
status reader::open_clusters() noexcept {
  const status s = cluster_table::open(part(cluster_bytes_), order_begin_, order_count_, clusters_);
  if (s != status::ok) return s;
  const bool merged = facts_.layout == host_layout::merged;
  std::uint64_t count = 0;
  for (std::uint32_t unit = 0; unit < (merged ? order_count_ : draw_count_); ++unit) {
    count += clusters_.clusters_of(merged ? unit : order_of_draw(unit));
  }
  if (count > facts_.polygon_count) return status::corrupt;
  cluster_count_ = static_cast<std::uint32_t>(count);
  return status::ok;
}

std::uint32_t reader::order_of_draw(std::uint32_t draw) const noexcept {
  return is_v0() ? draw : draw_columns_[6][draw];
}

std::uint32_t reader::order_begin(std::uint32_t number) const noexcept {
  if (!is_v0()) return order_begin_[number];
  draw_record d;
  return number == draw_count_ ? facts_.polygon_count : v0_draw(number, d) == status::ok ? d.first_stored : 0;
}

std::uint32_t reader::order_size(std::uint32_t number) const noexcept {
  return order_begin(number + 1) - order_begin(number);
}

status reader::draw(std::uint32_t number, draw_record& out) const noexcept {
  if (number >= draw_count_) return status::argument;
  if (is_v0()) return v0_draw(number, out);
  const auto column = [&](std::size_t which) { return draw_columns_[which][number]; };
  const std::uint32_t order = column(6);
  const std::uint32_t first = column(8);
  const std::uint32_t end = number + 1 < draw_count_ ? draw_columns_[8][number + 1] : facts_.polygon_count;
  if (order >= order_count_ || first > end || end > facts_.polygon_count) return status::corrupt;
  std::uint32_t named_group = no_named_group;
  if (!named_groups_.of_draw(number, named_group)) return status::corrupt;
  const draw_record d{.node = column(0),
                      .mesh = column(1),
                      .primitive = column(2),
                      .instance = column(3),
                      .material = column(4),
                      .group = column(5),
                      .first_source = column(7),
                      .polygon_count = end - first,
                      .first_stored = first,
                      .base_vertex = column(9),
                      .host_tag = std::uint64_t{column(11)} << 32 | column(10),
                      .flags = column(12),
                      .named_group = named_group};
  if (std::uint64_t{d.first_source} + d.polygon_count > facts_.polygon_count ||
      !draw_is_valid(d, facts_.layout, order, order_size(order))) {
    return status::corrupt;
  }
  out = d;
  return status::ok;
}

status reader::check_draws() noexcept {
  draw_table_rules rules(facts_.layout, facts_.polygon_count);
  for (std::uint32_t i = 0; i < draw_count_; ++i) {
    draw_record d;
    if (const status s = draw(i, d); s != status::ok) return s;
    const std::uint32_t order = order_of_draw(i);
    if (!rules.take(d, order, order_size(order))) return status::corrupt;
  }
  range_units_ = facts_.layout == host_layout::instanced ? draw_count_ : order_count_;
  return rules.complete(order_count_) ? status::ok : status::corrupt;
}

namespace {

// The first row below end in which a column, which does not descend, has at least a value; else end.
std::uint32_t first_at_least(const packed_column& column, std::uint32_t begin, std::uint32_t end,
                             std::uint32_t value) noexcept {
  while (begin < end) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    if (column[middle] < value) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

}  // namespace

std::uint32_t reader::first_draw_of(std::uint32_t range_unit) const noexcept {
  const bool merged = facts_.layout == host_layout::merged;
  return merged ? first_at_least(draw_columns_[5], 0, draw_count_, range_unit) : range_unit;
}

std::uint32_t reader::range_unit_begin(std::uint32_t number) const noexcept {
  if (number >= range_units_) return facts_.polygon_count;
  draw_record d;
  if (is_v0()) return v0_draw(number, d) == status::ok ? d.first_stored : facts_.polygon_count;
  const std::uint32_t draw = first_draw_of(number);
  return draw < draw_count_ ? draw_columns_[8][draw] : facts_.polygon_count;
}

status reader::orders(std::span<std::uint32_t> out) const noexcept {
  if (out.size() != order_begin(order_count_)) return status::argument;
  if (is_v0()) {
    for (std::uint32_t number = 0; number < order_count_; ++number) {
      const std::uint32_t begin = order_begin(number);
      const std::uint32_t end = order_begin(number + 1);
      if (begin > end || end > out.size()) return status::corrupt;
      for (std::uint32_t i = begin; i < end; ++i) out[i] = i - begin;
    }
    return status::ok;
  }
  const polygon_orders all(part(orders_), draw_count_, layout::reads_clusters && has_clusters_);
  if (!all.good() || all.polygons() != out.size() || all.count() != order_count_) return status::corrupt;
  for (std::uint32_t number = 0; number < order_count_; ++number) {
    const std::uint32_t begin = all.first_polygon(number);
    if (begin > out.size() || all.polygon_count(number) > out.size() - begin) return status::corrupt;
    if (!all.source_of_stored(number, out.subspan(begin, all.polygon_count(number)))) return status::corrupt;
  }
  return status::ok;
}

status reader::source_of_stored(std::span<std::uint32_t> out) const noexcept {
  if (out.size() != facts_.polygon_count) return status::argument;
  if (is_v0()) {  // stored order is source order
    std::iota(out.begin(), out.end(), 0u);
    return status::ok;
  }
  const polygon_orders all(part(orders_), draw_count_, layout::reads_clusters && has_clusters_);
  const bool merged = facts_.layout == host_layout::merged;
  for (std::uint32_t unit = 0; unit < range_units_; ++unit) {
    const std::uint32_t begin = range_unit_begin(unit);
    const std::uint32_t end = range_unit_begin(unit + 1);
    if (begin > end || end > out.size()) return status::corrupt;
    const std::span<std::uint32_t> polygons = out.subspan(begin, end - begin);
    if (!all.source_of_stored(merged ? unit : order_of_draw(unit), polygons)) return status::corrupt;
    if (const status s = make_sources(unit, polygons); s != status::ok) return s;
  }
  return status::ok;
}

// polygons: indices in a draw or draw group, which become source ids. Consecutive ones mostly belong to the same draw.
status reader::make_sources(std::uint32_t range_unit, std::span<std::uint32_t> polygons) const noexcept {
  const packed_column& firsts = draw_columns_[8];
  const std::uint32_t begin_draw = first_draw_of(range_unit);
  const std::uint32_t end_draw = std::min(first_draw_of(range_unit + 1), draw_count_);
  const std::uint32_t begin = firsts[begin_draw];
  std::uint32_t first = 1;  // of the last draw: none yet
  std::uint32_t end = 0;
  std::uint32_t first_source = 0;
  for (std::uint32_t& polygon : polygons) {
    const std::uint32_t place = begin + polygon;
    if (place < first || place >= end) {
      const std::uint32_t behind = first_at_least(firsts, begin_draw, end_draw, place + 1);
      if (behind == begin_draw) return status::corrupt;
      first = firsts[behind - 1];
      end = behind < draw_count_ ? firsts[behind] : facts_.polygon_count;
      first_source = draw_columns_[7][behind - 1];
      if (place < first || place >= end || std::uint64_t{first_source} + (end - first) > facts_.polygon_count) {
        return status::corrupt;
      }
    }
    polygon = first_source + (place - first);
  }
  return status::ok;
}

status reader::cell_box(std::uint32_t cell, box& out) const noexcept {
  if (cell >= cell_count_) return status::argument;
  if (lattice() != nullptr) return lattice_.cell_box(cell, out) ? status::ok : status::corrupt;
  const checked_reader in(part(cells_).subspan(is_v0() ? 0 : 4));
  const std::uint64_t at = cell * layout::cell_record_size;
  box b;
  if (grid() != nullptr) b = box_of(grid_.step(), grid_.place(cell));
  for (std::size_t axis = 0; axis < 3 && grid() == nullptr; ++axis) {
    if (!in.read_f32(at + 4 * axis, b.min[axis]) || !in.read_f32(at + 12 + 4 * axis, b.max[axis])) {
      return status::corrupt;
    }
  }
  if (!box_is_valid(b)) return status::corrupt;
  out = b;
  return status::ok;
}

// open has checked the cells of a lattice.
status reader::check_cells() const noexcept {
  box b;
  for (std::uint32_t i = 0; i < cell_count_ && lattice() == nullptr; ++i) {
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
  if (is_v0()) return v0_certificate(number, out);
  const certificate_record c = certificate_of(certificate_columns_, number, number);
  if (!certificate_is_valid(c)) return status::corrupt;
  out = c;
  return status::ok;
}

// open leaves the trees of regions out, which only tools use.
status reader::check_regions() const noexcept {
  if (!viewpoints_.exists()) return status::ok;
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    box bounds;
    if (const status s = cell_box(cell, bounds); s != status::ok) return s;
    const status s = viewpoints_.parts(cell, grown_box(bounds, facts_.margin), [](const region_part&) {});
    if (s != status::ok) return s;
  }
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
