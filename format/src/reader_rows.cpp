// The functions of the reader for rows: the chunk directory, chunks, codes, decoding, and the checks over all rows.
#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <utility>

#include "checked_reader.h"
#include "checksum.h"
#include "code_table.h"
#include "row_chunk.h"
#include "sightcell/format/draw_ranges.h"
#include "sightcell/format/importance_classes.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"

namespace sightcell::format {
namespace {

// The number of runs of a set before the first volume. Volumes begin with number `polygons`, maybe inside the next run.
std::size_t runs_without_volumes(std::span<const run> set, std::uint32_t polygons) noexcept {
  const auto is_without = [&](const run& r) { return std::uint64_t{r.first} + r.count <= polygons; };
  return static_cast<std::size_t>(std::partition_point(set.begin(), set.end(), is_without) - set.begin());
}

std::uint64_t sum_of(std::span<const run> runs) noexcept {
  std::uint64_t sum = 0;
  for (const run& r : runs) sum += r.count;
  return sum;
}

// Begins the lifetime of numbers in raw memory.
template <class T>
std::span<T> as_array(std::span<std::byte> bytes) noexcept {
  const std::size_t count = bytes.size() / sizeof(T);
  auto* first = reinterpret_cast<T*>(bytes.data());
  std::uninitialized_default_construct_n(first, count);
  return {first, count};
}

}  // namespace

row_bounds reader::bounds() const noexcept {
  return {item_count(), run_bound_, list_bound_};
}

status reader::chunk_extent(std::uint32_t chunk, extent& out, std::uint32_t& checksum) const noexcept {
  if (chunk >= chunk_count()) return status::argument;
  const checked_reader in(part(directory_));
  const std::uint64_t at = chunk * layout::chunk_record_size;
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  if (!in.read_u64(at, offset) || !in.read_u32(at + 8, size) || !in.read_u32(at + 12, checksum)) return status::corrupt;
  if (offset > rows_.size || size > rows_.size - offset) return status::corrupt;
  out = {rows_.offset + offset, size};
  return status::ok;
}

status reader::check_chunk(std::uint32_t chunk) const noexcept {
  extent where;
  std::uint32_t stored = 0;
  if (const status s = chunk_extent(chunk, where, stored); s != status::ok) return s;
  return crc32c(part(where)) == stored ? status::ok : status::checksum;
}

status reader::chunk_place(std::uint32_t chunk, std::uint64_t& offset, std::uint32_t& size) const noexcept {
  extent where;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(chunk, where, checksum); s != status::ok) return s;
  offset = where.offset;
  size = static_cast<std::uint32_t>(where.size);
  return status::ok;
}

status reader::check_chunk(std::uint32_t chunk, std::span<const std::byte> bytes) const noexcept {
  extent where;
  std::uint32_t stored = 0;
  if (const status s = chunk_extent(chunk, where, stored); s != status::ok) return s;
  return bytes.size() == where.size && crc32c(bytes) == stored ? status::ok : status::checksum;
}

// Chunks follow each other and fill the rows section.
status reader::check_directory() const noexcept {
  std::uint64_t next = rows_.offset;
  for (std::uint32_t chunk = 0; chunk < chunk_count(); ++chunk) {
    extent where;
    std::uint32_t checksum = 0;
    if (const status s = chunk_extent(chunk, where, checksum); s != status::ok) return s;
    if (where.offset != next) return status::corrupt;
    next += where.size;
  }
  if (next != rows_.offset + rows_.size) return status::corrupt;
  row_place place;
  for (std::uint32_t cell = 0; cell < cell_count_ && is_v0(); ++cell) {
    if (const status s = v0_row_bytes(cell, place); s != status::ok) return s;
  }
  return status::ok;
}

std::size_t reader::codes_size() const noexcept {
  if (is_v0()) return 0;
  if (!layout::reads_clusters || !has_clusters_) return sizeof(row_codes);
  const std::uint64_t room = cluster_borders::room(range_units_, order_count_, clusters_.first_cluster(order_count_));
  return sizeof(row_codes) + static_cast<std::size_t>(room) * sizeof(std::uint32_t);
}

// memory: behind the code tables, of the size that codes_size() has for it.
bool reader::fill_clusters(row_codes& codes, std::span<std::byte> memory) const noexcept {
  const bool merged = facts_.layout == host_layout::merged;
  return codes.clusters.fill(
      as_array<std::uint32_t>(memory), clusters_, range_units_, order_count_, facts_.polygon_count, cluster_count_,
      [&](std::uint32_t unit) { return merged ? unit : order_of_draw(unit); },
      [&](std::uint32_t unit) { return range_unit_begin(unit); });
}

const cluster_borders& reader::borders_of_clusters(const row_codes& codes) noexcept {
  return codes.clusters;
}

status reader::make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept {
  out = nullptr;
  if (is_v0()) return status::ok;
  const std::size_t size = codes_size();
  if (memory.size() < size) return status::capacity;
  auto* codes = new (memory.data()) row_codes;
  std::span<const std::byte> bytes = part(codes_);
  for (run_code* kind : {&codes->own, &codes->removed, &codes->added}) {
    symbol_lengths gap{};
    symbol_lengths more{};
    if (!read_code_lengths(bytes, gap) || !read_code_lengths(bytes, more) || !kind->assign(gap, more)) {
      return status::corrupt;
    }
  }
  if (!bytes.empty()) return status::corrupt;
  if (layout::reads_clusters && has_clusters_ &&
      !fill_clusters(*codes, memory.first(size).subspan(sizeof(row_codes)))) {
    return status::corrupt;
  }
  out = codes;
  return status::ok;
}

std::size_t reader::scratch_size() const noexcept {
  if (is_v0()) return run_bound_ * sizeof(run);
  return bounds().scratch_room() * sizeof(std::uint32_t);
}

// Decodes a set as it is stored, polygons and volumes together.
status reader::decode_items(std::uint32_t cell, const row_codes* codes, std::span<run> out,
                            std::span<std::byte> scratch, std::size_t& count) const noexcept {
  count = 0;
  if (cell >= cell_count_) return status::argument;
  if (is_v0()) {
    if (out.size() < run_bound_ || scratch.size() < scratch_size()) return status::capacity;
    return v0_decode_row(cell, out, as_array<run>(scratch), count);
  }
  extent where;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(chunk_of(cell), where, checksum); s != status::ok) return s;
  return decode_items(cell, part(where), codes, out, scratch, count);
}

status reader::decode_items(std::uint32_t cell, std::span<const std::byte> chunk, const row_codes* codes,
                            std::span<run> out, std::span<std::byte> scratch, std::size_t& count) const noexcept {
  count = 0;
  if (cell >= cell_count_ || codes == nullptr) return status::argument;
  if (out.size() < run_bound_ || scratch.size() < scratch_size()) return status::capacity;
  const cell_chunk cells = chunks_.chunk_of(cell);
  row_chunk rows;
  if (!rows.open(chunk, cells.cells)) return status::corrupt;
  std::span<const std::uint32_t> borders;
  std::uint64_t end = 0;
  const status s =
      rows.decode(cell - cells.first_cell, *codes, bounds(), as_array<std::uint32_t>(scratch), borders, end);
  if (s != status::ok) return s;
  count = borders.size() / 2;
  for (std::size_t i = 0; i < count; ++i) out[i] = {borders[2 * i], borders[2 * i + 1] - borders[2 * i]};
  if (layout::reads_clusters && codes->clusters.exist()) codes->clusters.expand(out.first(count));
  return status::ok;
}

status reader::decode_row(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                          std::size_t& count) const noexcept {
  const status s = decode_items(cell, codes, out, scratch, count);
  if (volumes_.count() == 0 || s != status::ok) return s;
  const std::size_t at = runs_without_volumes(out.first(count), facts_.polygon_count);
  const bool cut = at < count && out[at].first < facts_.polygon_count;
  if (cut) out[at].count = facts_.polygon_count - out[at].first;
  count = cut ? at + 1 : at;
  return status::ok;
}

status reader::decode_row(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                          row_parts& parts) const noexcept {
  parts = {};
  if (out.size() < row_room()) return status::capacity;
  std::size_t count = 0;
  if (const status s = decode_items(cell, codes, out, scratch, count); s != status::ok) return s;
  parts = split(out, count);
  return status::ok;
}

status reader::decode_row(std::uint32_t cell, std::span<const std::byte> chunk, const row_codes* codes,
                          std::span<run> out, std::span<std::byte> scratch, row_parts& parts) const noexcept {
  parts = {};
  if (is_v0()) return status::version;
  if (out.size() < row_room()) return status::capacity;
  std::size_t count = 0;
  if (const status s = decode_items(cell, chunk, codes, out, scratch, count); s != status::ok) return s;
  parts = split(out, count);
  return status::ok;
}

// Divides out[0 .. count) into polygons and volumes; there is room for one run more.
row_parts reader::split(std::span<run> out, std::size_t count) const noexcept {
  const std::uint32_t polygons = facts_.polygon_count;
  std::size_t at = runs_without_volumes(out.first(count), polygons);
  if (at < count && out[at].first < polygons) {
    const auto from = out.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = out.begin() + static_cast<std::ptrdiff_t>(count);
    std::move_backward(from, end, end + 1);
    ++count;
    out[at].count = polygons - out[at].first;
    out[at + 1] = {polygons, out[at + 1].count - out[at].count};
    ++at;
  }
  for (run& r : out.subspan(at, count - at)) r.first -= polygons;
  return {out.first(at), out.subspan(at, count - at)};
}

status reader::row(std::uint32_t cell, row_record& out) const noexcept {
  if (cell >= cell_count_) return status::argument;
  if (is_v0()) return v0_row(cell, out);
  const cell_chunk cells = chunks_.chunk_of(cell);
  extent where;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(cells.number, where, checksum); s != status::ok) return s;
  row_chunk chunk;
  row_head head;
  const std::uint32_t place = cell - cells.first_cell;
  if (!chunk.open(part(where), cells.cells) || !chunk.head(place, head)) return status::corrupt;
  const std::uint64_t begin = chunk.begin_of(place);
  std::uint64_t end = chunk.end_of_rows();
  row_record record;
  record.delta = head.delta;
  if (head.delta) record.reference = cell - place + head.reference;
  for (std::uint32_t other = 0; other < chunk.rows(); ++other) {
    const std::uint64_t there = chunk.begin_of(other);
    if (there > begin) end = std::min(end, there);
    if (other < place && there == begin) record.shared = true;
  }
  record.size = static_cast<std::uint32_t>(end - begin);
  out = record;
  return status::ok;
}

std::uint64_t reader::count_ranges(std::span<const run> runs) const noexcept {
  std::uint64_t ranges = 0;
  // If the bytes changed since open the count is wrong, nothing worse.
  for_each_draw_range(
      runs, range_units_, facts_.polygon_count, [&](std::uint32_t unit) { return range_unit_begin(unit); },
      [&](std::uint32_t, std::uint32_t, std::uint32_t) { ++ranges; });
  return ranges;
}

void reader::add_draw_calls(std::span<const run> runs, row_statistics& sums) const noexcept {
  std::uint32_t last_unit = 0xFFFFFFFFu;
  std::uint32_t end = 0;  // of the range before
  for_each_draw_range(
      runs, range_units_, facts_.polygon_count, [&](std::uint32_t unit) { return range_unit_begin(unit); },
      [&](std::uint32_t unit, std::uint32_t first, std::uint32_t count) {
        ++sums.ranges;
        if (unit != last_unit) ++sums.draws;
        if (unit != last_unit || first - end >= row_statistics::joined_gap) ++sums.joined_ranges;
        last_unit = unit;
        end = first + count;
      });
}

// Rows follow each other in the order of the first cell that uses them; a shared row is an earlier one.
status reader::check_chunk_filled(const cell_chunk& cells, const row_codes* codes,
                                  std::span<std::byte> scratch) const noexcept {
  if (is_v0()) return v0_check_chunk_filled(cells);
  extent where;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(cells.number, where, checksum); s != status::ok) return s;
  row_chunk chunk;
  if (!chunk.open(part(where), cells.cells)) return status::corrupt;
  const row_bounds limits = bounds();
  std::uint64_t next = 0;
  for (std::uint32_t place = 0; place < chunk.rows(); ++place) {
    const std::uint64_t begin = chunk.begin_of(place);
    if (begin == next) {
      std::span<const std::uint32_t> borders;
      const status s = chunk.decode(place, *codes, limits, as_array<std::uint32_t>(scratch), borders, next);
      if (s != status::ok) return s;
      continue;
    }
    bool known = false;
    for (std::uint32_t other = 0; other < place && !known; ++other) known = chunk.begin_of(other) == begin;
    if (!known) return status::corrupt;
  }
  return next == chunk.end_of_rows() ? status::ok : status::corrupt;
}

// Tests that each source id occurs once. Each number is below their count and is moved to its own index, where a
// duplicate is found.
status reader::check_stored(std::span<std::uint32_t> stored) const noexcept {
  if (const status s = source_of_stored(stored); s != status::ok) return s;
  for (std::uint32_t i = 0; i < stored.size(); ++i) {
    while (stored[i] != i) {
      std::uint32_t& place = stored[stored[i]];
      if (place == stored[i]) return status::corrupt;
      std::swap(stored[i], place);
    }
  }
  return status::ok;
}

std::size_t reader::check_room() const noexcept {
  return std::max<std::size_t>(facts_.polygon_count, volumes_.differ_room());
}

status reader::check(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                     std::span<std::uint32_t> stored) const noexcept {
  if (out.size() < run_bound_ || scratch.size() < scratch_size() || stored.size() < check_room()) {
    return status::capacity;
  }
  if (!is_v0() && codes == nullptr) return status::argument;
  for (std::uint32_t i = 0; i < section_count_; ++i) {
    if (const status s = check_section(i); s != status::ok) return s;
  }
  if (const status s = check_stored(stored.first(facts_.polygon_count)); s != status::ok) return s;
  if (!volumes_.places_differ(stored)) return status::corrupt;
  if (const status s = check_regions(); s != status::ok) return s;
  if (const status s = check_rows(codes, out, scratch); s != status::ok) return s;
  return check_importance(codes, out, scratch);
}

// Checks chunks and rows, and that they reach the bounds.
status reader::check_rows(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept {
  std::size_t most_runs = 0;
  std::uint64_t most_ranges = 0;
  for (std::uint32_t cell = 0; cell < cell_count_;) {
    const cell_chunk chunk = chunks_.chunk_of(cell);
    if (const status s = check_chunk(chunk.number); s != status::ok) return s;
    if (const status s = check_chunk_filled(chunk, codes, scratch); s != status::ok) return s;
    cell = chunk.end();
  }
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    std::size_t count = 0;
    if (const status s = decode_items(cell, codes, out, scratch, count); s != status::ok) return s;
    const std::span<const run> set = out.first(count);
    most_runs = std::max(most_runs, count);
    const std::size_t of_volumes = count - runs_without_volumes(set, facts_.polygon_count);
    most_ranges = std::max(most_ranges, count_ranges(set) + of_volumes);
  }
  return most_runs == run_bound_ && most_ranges == range_bound_ ? status::ok : status::corrupt;
}

status reader::importance(importance_classes& out) const noexcept {
  return has_importance_ ? importance_classes::open(part(importance_), chunks_, out) : status::argument;
}

// classes: room for one per polygon of the scene.
status reader::check_importance(const row_codes* codes, std::span<run> out,
                                std::span<std::byte> scratch) const noexcept {
  if (!has_importance_) return status::ok;
  importance_classes all;
  if (const status s = importance(all); s != status::ok) return s;
  for (std::uint32_t chunk = 0; chunk < chunk_count(); ++chunk) {
    if (const status s = all.check_chunk(chunk); s != status::ok) return s;
  }
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    std::size_t count = 0;
    if (const status s = decode_row(cell, codes, out, scratch, count); s != status::ok) return s;
    const auto polygons = static_cast<std::uint32_t>(sum_of(out.first(count)));  // runs are inside polygon_count
    const importance_classes::class_sink ignore = [](void*, std::uint8_t, std::uint32_t) noexcept {};
    if (const status s = all.decode(cell, polygons, ignore, nullptr); s != status::ok) return s;
  }
  return status::ok;
}

status reader::statistics(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                          row_statistics& sums) const noexcept {
  if (out.size() < row_room() || scratch.size() < scratch_size()) return status::capacity;
  row_statistics total;
  total.cells = cell_count_;
  total.row_bytes = rows_.size;
  total.directory_bytes = directory_.size + border_bytes_.size + codes_.size;
  total.chunks = chunk_count();
  for (std::uint32_t chunk = 0; chunk < chunk_count(); ++chunk) {
    std::uint64_t unused = 0;
    std::uint32_t size = 0;
    if (const status s = chunk_place(chunk, unused, size); s != status::ok) return s;
    total.largest_chunk = std::max<std::uint64_t>(total.largest_chunk, size);
    if (const status s = check_chunk(chunk); s != status::ok) return s;
  }
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    row_record record;
    row_parts parts;
    if (const status s = row(cell, record); s != status::ok) return s;
    if (const status s = decode_row(cell, codes, out, scratch, parts); s != status::ok) return s;
    total.delta_rows += record.delta ? 1 : 0;
    total.shared_rows += record.shared ? 1 : 0;
    total.runs += parts.polygons.size();
    add_draw_calls(parts.polygons, total);
    total.polygons += sum_of(parts.polygons);
    if (layout::reads_clusters && has_clusters_)
      codes->clusters.for_each(parts.polygons, [&](const run& r) { total.clusters += r.count; });
    total.volumes += sum_of(parts.volumes);
    total.volume_runs += parts.volumes.size();
  }
  sums = total;
  return status::ok;
}

}  // namespace sightcell::format
