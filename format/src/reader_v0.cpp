// The functions of the reader for files of version 0 (SPEC.md, "Version 0"): fixed records, rows of varints, stored
// order is source order.
#include <array>
#include <utility>

#include "checked_reader.h"
#include "record_rules.h"
#include "row_decoder.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"

namespace sightcell::format {

status reader::v0_draw(std::uint32_t number, draw_record& out) const noexcept {
  const checked_reader in(part(draws_));
  const std::uint64_t at = number * layout::v0_draw_record_size;
  draw_record d;
  if (!in.read_u32(at, d.node) || !in.read_u32(at + 4, d.mesh) || !in.read_u32(at + 8, d.primitive) ||
      !in.read_u32(at + 12, d.instance) || !in.read_u32(at + 16, d.material) || !in.read_u32(at + 20, d.group) ||
      !in.read_u32(at + 24, d.first_source) || !in.read_u32(at + 28, d.polygon_count) ||
      !in.read_u32(at + 32, d.first_stored) || !in.read_u32(at + 36, d.base_vertex) ||
      !in.read_u64(at + 40, d.host_tag)) {
    return status::corrupt;
  }
  if (std::uint64_t{d.first_stored} + d.polygon_count > facts_.polygon_count || d.first_source != d.first_stored ||
      d.group != 0) {
    return status::corrupt;
  }
  out = d;
  return status::ok;
}

status reader::v0_certificate(std::uint32_t number, certificate_record& out) const noexcept {
  const checked_reader in(part(certificate_));
  const std::uint64_t at = number * layout::v0_certificate_record_size;
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

status reader::v0_row_bytes(std::uint32_t cell, row_place& out) const noexcept {
  if (cell >= cell_count_) return status::argument;
  extent chunk;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(chunk_of(cell), chunk, checksum); s != status::ok) return s;
  const checked_reader in(part(directory_));
  const std::uint64_t at = chunk_count() * layout::chunk_record_size + cell * layout::v0_row_record_size;
  std::uint32_t offset = 0;
  std::uint32_t size = 0;
  if (!in.read_u32(at, offset) || !in.read_u32(at + 4, size)) return status::corrupt;
  if (size == 0 || offset > chunk.size || size > chunk.size - offset) return status::corrupt;
  out = {part({chunk.offset + offset, size}), offset};
  return status::ok;
}

status reader::v0_row(std::uint32_t cell, row_record& out) const noexcept {
  row_place place;
  row_header header;
  if (const status s = v0_row_bytes(cell, place); s != status::ok) return s;
  if (!read_row_header(place.bytes, header)) return status::corrupt;
  const std::uint32_t first_of_chunk = cell - cell % layout::cells_per_block;
  row_record record;
  record.size = static_cast<std::uint32_t>(place.bytes.size());
  record.delta = header.delta;
  if (header.delta) record.reference = first_of_chunk + header.reference;
  for (std::uint32_t other = first_of_chunk; other < cell && !record.shared; ++other) {
    row_place earlier;
    if (const status s = v0_row_bytes(other, earlier); s != status::ok) return s;
    record.shared = earlier.offset == place.offset;
  }
  out = record;
  return status::ok;
}

// A row of depth d has a chain of d references. The last one is decoded first, then each difference from one buffer
// into the other, in such an order that the result is in out.
status reader::v0_decode_row(std::uint32_t cell, std::span<run> out, std::span<run> scratch,
                             std::size_t& count) const noexcept {
  std::array<row_header, layout::max_reference_depth + 1> chain;
  std::uint32_t depth = 0;
  for (std::uint32_t at = cell;;) {
    row_place place;
    if (const status s = v0_row_bytes(at, place); s != status::ok) return s;
    if (!read_row_header(place.bytes, chain[depth])) return status::corrupt;
    if (!chain[depth].delta) break;
    if (depth == layout::max_reference_depth) return status::corrupt;
    at = cell - cell % layout::cells_per_block + chain[depth].reference;
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

// Rows follow each other in the order of the first cell that uses them; a shared row is an earlier one, whole.
status reader::v0_check_chunk_filled(const cell_chunk& chunk) const noexcept {
  extent where;
  std::uint32_t checksum = 0;
  if (const status s = chunk_extent(chunk.number, where, checksum); s != status::ok) return s;
  std::uint64_t next = 0;
  for (std::uint32_t cell = chunk.first_cell; cell < chunk.end(); ++cell) {
    row_place place;
    if (const status s = v0_row_bytes(cell, place); s != status::ok) return s;
    if (place.offset == next) {
      next += place.bytes.size();
      continue;
    }
    bool known = false;
    for (std::uint32_t other = chunk.first_cell; other < cell && !known; ++other) {
      row_place earlier;
      if (const status s = v0_row_bytes(other, earlier); s != status::ok) return s;
      known = earlier.offset == place.offset && earlier.bytes.size() == place.bytes.size();
    }
    if (!known) return status::corrupt;
  }
  return next == where.size ? status::ok : status::corrupt;
}

}  // namespace sightcell::format
