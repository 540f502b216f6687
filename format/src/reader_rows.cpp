// The part of the reader that deals with rows: the row directory, chunks, decoding and the checks over all rows.
#include <algorithm>
#include <array>
#include <utility>

#include "checked_reader.h"
#include "checksum.h"
#include "row_decoder.h"
#include "sightcell/format/draw_ranges.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"

namespace sightcell::format {

std::uint32_t reader::chunk_count() const noexcept {
  return (cell_count_ + layout::cells_per_chunk - 1) / layout::cells_per_chunk;
}

std::uint32_t reader::chunk_of(std::uint32_t cell) noexcept {
  return cell / layout::cells_per_chunk;
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

status reader::row_bytes(std::uint32_t cell, row_place& out) const noexcept {
  if (cell >= cell_count_) return status::argument;
  extent chunk;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(chunk_of(cell), chunk, checksum); s != status::ok) return s;
  const checked_reader in(part(directory_));
  const std::uint64_t at = chunk_count() * layout::chunk_record_size + cell * layout::row_record_size;
  std::uint32_t offset = 0;
  std::uint32_t size = 0;
  if (!in.read_u32(at, offset) || !in.read_u32(at + 4, size)) return status::corrupt;
  if (size == 0 || offset > chunk.size || size > chunk.size - offset) return status::corrupt;
  out = {part({chunk.offset + offset, size}), offset};
  return status::ok;
}

// Chunks lie one behind the other and fill the rows section.
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
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    if (const status s = row_bytes(cell, place); s != status::ok) return s;
  }
  return status::ok;
}

status reader::row(std::uint32_t cell, row_record& out) const noexcept {
  row_place place;
  row_header header;
  if (const status s = row_bytes(cell, place); s != status::ok) return s;
  if (!read_row_header(place.bytes, header)) return status::corrupt;
  const std::uint32_t first_of_chunk = cell - cell % layout::cells_per_chunk;
  row_record record;
  record.size = static_cast<std::uint32_t>(place.bytes.size());
  record.delta = header.delta;
  if (header.delta) record.reference = first_of_chunk + header.reference;
  for (std::uint32_t other = first_of_chunk; other < cell && !record.shared; ++other) {
    row_place earlier;
    if (const status s = row_bytes(other, earlier); s != status::ok) return s;
    record.shared = earlier.offset == place.offset;
  }
  out = record;
  return status::ok;
}

std::uint32_t reader::row_size(std::uint32_t cell) const noexcept {
  row_place place;
  return row_bytes(cell, place) == status::ok ? static_cast<std::uint32_t>(place.bytes.size()) : 0;
}

bool reader::is_delta_row(std::uint32_t cell) const noexcept {
  row_place place;
  row_header header;
  return row_bytes(cell, place) == status::ok && read_row_header(place.bytes, header) && header.delta;
}

// A row of depth d stands on d references. The root is decoded first, then each difference from one buffer into the
// other, begun so that the last one lands in out.
status reader::decode_row(std::uint32_t cell, std::span<run> out, std::span<run> scratch,
                          std::size_t& count) const noexcept {
  count = 0;
  if (cell >= cell_count_) return status::argument;
  if (out.size() < run_bound_ || scratch.size() < run_bound_) return status::capacity;
  std::array<row_header, layout::max_reference_depth + 1> chain;
  std::uint32_t depth = 0;
  for (std::uint32_t at = cell;;) {
    row_place place;
    if (const status s = row_bytes(at, place); s != status::ok) return s;
    if (!read_row_header(place.bytes, chain[depth])) return status::corrupt;
    if (!chain[depth].delta) break;
    if (depth == layout::max_reference_depth) return status::corrupt;
    at = cell - cell % layout::cells_per_chunk + chain[depth].reference;
    if (at >= cell_count_) return status::corrupt;
    ++depth;
  }

  std::span<run> target = out.first(run_bound_);
  std::span<run> source = scratch.first(run_bound_);
  if (depth % 2 != 0) std::swap(target, source);
  std::size_t decoded = 0;
  if (const status s = decode_own_row(chain[depth], facts_.polygon_count, target, decoded); s != status::ok) return s;
  while (depth > 0) {
    --depth;
    std::swap(target, source);
    const std::span<const run> reference = source.first(decoded);
    const status s = decode_delta_row(chain[depth], facts_.polygon_count, reference, target, decoded);
    if (s != status::ok) return s;
  }
  count = decoded;
  return status::ok;
}

std::uint64_t reader::count_ranges(std::span<const run> runs) const noexcept {
  std::uint64_t ranges = 0;
  // Bytes that changed since open make a wrong count, nothing worse.
  const auto first_of = [&](std::uint32_t number) {
    draw_record d;
    return draw(number, d) == status::ok ? d.first_stored : facts_.polygon_count;
  };
  for_each_draw_range(runs, draw_count_, facts_.polygon_count, first_of,
                      [&](std::uint32_t, std::uint32_t, std::uint32_t) { ++ranges; });
  return ranges;
}

// Rows in the order of the first cell that uses them, one behind the other; a shared row is an earlier one, whole.
status reader::check_chunk_filled(std::uint32_t chunk) const noexcept {
  extent where;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(chunk, where, checksum); s != status::ok) return s;
  const std::uint32_t begin = chunk * layout::cells_per_chunk;
  const std::uint32_t end = std::min(cell_count_, begin + layout::cells_per_chunk);
  std::uint64_t next = 0;
  for (std::uint32_t cell = begin; cell < end; ++cell) {
    row_place place;
    if (const status s = row_bytes(cell, place); s != status::ok) return s;
    if (place.offset == next) {
      next += place.bytes.size();
      continue;
    }
    bool known = false;
    for (std::uint32_t other = begin; other < cell && !known; ++other) {
      row_place earlier;
      if (const status s = row_bytes(other, earlier); s != status::ok) return s;
      known = earlier.offset == place.offset && earlier.bytes.size() == place.bytes.size();
    }
    if (!known) return status::corrupt;
  }
  return next == where.size ? status::ok : status::corrupt;
}

status reader::check(std::span<run> out, std::span<run> scratch) const noexcept {
  if (out.size() < run_bound_ || scratch.size() < run_bound_) return status::capacity;
  for (std::uint32_t i = 0; i < section_count_; ++i) {
    if (const status s = check_section(i); s != status::ok) return s;
  }
  std::size_t most_runs = 0;
  std::uint64_t most_ranges = 0;
  for (std::uint32_t chunk = 0; chunk < chunk_count(); ++chunk) {
    if (const status s = check_chunk(chunk); s != status::ok) return s;
    if (const status s = check_chunk_filled(chunk); s != status::ok) return s;
  }
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    std::size_t count = 0;
    if (const status s = decode_row(cell, out, scratch, count); s != status::ok) return s;
    most_runs = std::max(most_runs, count);
    most_ranges = std::max(most_ranges, count_ranges(out.first(count)));
  }
  return most_runs == run_bound_ && most_ranges == range_bound_ ? status::ok : status::corrupt;
}

status reader::statistics(std::span<run> out, std::span<run> scratch, row_statistics& sums) const noexcept {
  if (out.size() < run_bound_ || scratch.size() < run_bound_) return status::capacity;
  row_statistics total;
  total.cells = cell_count_;
  total.row_bytes = rows_.size;
  total.directory_bytes = directory_.size;
  for (std::uint32_t chunk = 0; chunk < chunk_count(); ++chunk) {
    if (const status s = check_chunk(chunk); s != status::ok) return s;
  }
  for (std::uint32_t cell = 0; cell < cell_count_; ++cell) {
    row_record record;
    std::size_t count = 0;
    if (const status s = row(cell, record); s != status::ok) return s;
    if (const status s = decode_row(cell, out, scratch, count); s != status::ok) return s;
    total.delta_rows += record.delta ? 1 : 0;
    total.shared_rows += record.shared ? 1 : 0;
    total.runs += count;
    total.ranges += count_ranges(out.first(count));
    for (const run& r : out.first(count)) total.polygons += r.count;
  }
  sums = total;
  return status::ok;
}

}  // namespace sightcell::format
