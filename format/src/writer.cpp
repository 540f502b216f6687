#include "sightcell/format/writer.h"

#include <algorithm>
#include <functional>
#include <new>
#include <stdexcept>
#include <utility>

#include "byte_sink.h"
#include "checksum.h"
#include "chunk_encoder.h"
#include "record_rules.h"
#include "row_encoder.h"
#include "sightcell/format/draw_ranges.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

struct section_bytes {
  std::uint32_t id = 0;
  bool required = false;
  std::vector<std::byte> bytes;
};

// What is known of the rows besides their bytes.
struct row_facts {
  std::vector<std::byte> directory;
  std::uint32_t run_bound = 0;
  std::uint32_t range_bound = 0;
};

status check_draws(const file_contents& contents) {
  std::uint64_t next = 0;
  for (const draw_record& d : contents.draws) {
    if (d.first_source != next || d.first_stored != next || d.group != 0) return status::argument;
    next += d.polygon_count;
    if (next > contents.facts.polygon_count) return status::argument;
  }
  return next == contents.facts.polygon_count ? status::ok : status::argument;
}

status check_cells(const file_contents& contents) {
  const bool sets_missing = !contents.cells.empty() && !contents.cell_sets.get;
  if (sets_missing || contents.cells.size() != contents.cell_sets.count) return status::argument;
  for (const box& b : contents.cells) {
    if (!box_is_valid(b)) return status::argument;
  }
  return status::ok;
}

status check_set(std::span<const std::uint32_t> set, std::uint32_t polygon_count) {
  if (!set.empty() && set.back() >= polygon_count) return status::argument;
  if (std::adjacent_find(set.begin(), set.end(), std::greater_equal<>()) != set.end()) return status::argument;
  return status::ok;
}

status check_contents(const file_contents& contents) {
  if (contents.facts.polygon_count > layout::max_polygons || contents.cells.size() > layout::max_cells ||
      contents.draws.size() > layout::max_draws || contents.settings.size() > layout::max_settings_size) {
    return status::limit;
  }
  if (!facts_are_valid(contents.facts)) return status::argument;
  if (contents.facts.margin > layout::max_margin) return status::limit;
  if (const status s = check_draws(contents); s != status::ok) return s;
  if (const status s = check_cells(contents); s != status::ok) return s;
  if (!contents.certificate.empty() && contents.certificate.size() != contents.cells.size()) return status::argument;
  for (std::size_t i = 0; i < contents.certificate.size(); ++i) {
    const certificate_record& c = contents.certificate[i];
    if (c.cell != i || !certificate_is_valid(c)) return status::argument;
  }
  return status::ok;
}

std::uint32_t count_ranges(const file_contents& contents, std::span<const run> runs) {
  std::uint32_t ranges = 0;
  for_each_draw_range(
      runs, static_cast<std::uint32_t>(contents.draws.size()), contents.facts.polygon_count,
      [&](std::uint32_t d) { return contents.draws[d].first_stored; },
      [&](std::uint32_t, std::uint32_t, std::uint32_t) { ++ranges; });
  return ranges;
}

std::size_t directory_size(std::size_t cells) {
  const std::size_t chunks = (cells + layout::cells_per_chunk - 1) / layout::cells_per_chunk;
  return chunks * layout::chunk_record_size + cells * layout::row_record_size;
}

// Appends the rows to file.
status encode_rows(const file_contents& contents, std::vector<std::byte>& file, row_facts& out) {
  const std::size_t rows_begin = file.size();
  std::vector<std::byte> row_records;
  byte_sink chunks(out.directory);
  byte_sink rows(row_records);
  std::vector<std::uint32_t> set;
  std::vector<std::vector<run>> sets;
  for (std::size_t begin = 0; begin < contents.cells.size(); begin += layout::cells_per_chunk) {
    const std::size_t end = std::min<std::size_t>(contents.cells.size(), begin + layout::cells_per_chunk);
    sets.clear();
    for (std::size_t cell = begin; cell < end; ++cell) {
      set.clear();
      if (const status s = contents.cell_sets.get(static_cast<std::uint32_t>(cell), set); s != status::ok) return s;
      if (const status s = check_set(set, contents.facts.polygon_count); s != status::ok) return s;
      sets.push_back(runs_of(set));
      out.run_bound = std::max(out.run_bound, static_cast<std::uint32_t>(sets.back().size()));
      out.range_bound = std::max(out.range_bound, count_ranges(contents, sets.back()));
    }
    const encoded_chunk chunk = encode_chunk(sets, contents.facts.polygon_count);
    if (chunk.bytes.size() > layout::max_chunk_size) return status::limit;
    chunks.put_u64(file.size() - rows_begin);
    chunks.put_u32(static_cast<std::uint32_t>(chunk.bytes.size()));
    chunks.put_u32(crc32c(chunk.bytes));
    byte_sink(file).put_bytes(chunk.bytes);
    for (const encoded_row& r : chunk.rows) {
      rows.put_u32(static_cast<std::uint32_t>(r.offset));
      rows.put_u32(static_cast<std::uint32_t>(r.size));
    }
  }
  chunks.put_bytes(row_records);
  return status::ok;
}

std::vector<std::byte> encode_draws(std::span<const draw_record> draws) {
  std::vector<std::byte> bytes;
  byte_sink out(bytes);
  for (const draw_record& d : draws) {
    for (const std::uint32_t value : {d.node, d.mesh, d.primitive, d.instance, d.material, d.group, d.first_source,
                                      d.polygon_count, d.first_stored, d.base_vertex}) {
      out.put_u32(value);
    }
    out.put_u64(d.host_tag);
  }
  return bytes;
}

std::vector<std::byte> encode_cells(std::span<const box> cells) {
  std::vector<std::byte> bytes;
  byte_sink out(bytes);
  for (const box& b : cells) {
    for (const float value : b.min) out.put_f32(value);
    for (const float value : b.max) out.put_f32(value);
  }
  return bytes;
}

std::vector<std::byte> encode_certificate(std::span<const certificate_record> certificate) {
  std::vector<std::byte> bytes;
  byte_sink out(bytes);
  for (const certificate_record& c : certificate) {
    out.put_u64(c.rays);
    out.put_u64(c.misses);
    out.put_f64(c.upper_bound);
    out.put_f64(c.confidence);
    out.put_u64(c.seed);
  }
  return bytes;
}

// All but the rows, which come last, so that everything a reader checks at once lies together at the front. The
// directory is as large as it will be.
std::vector<section_bytes> front_sections(const file_contents& contents) {
  std::vector<section_bytes> sections;
  sections.push_back({layout::section_draws, true, encode_draws(contents.draws)});
  sections.push_back({layout::section_cells, true, encode_cells(contents.cells)});
  sections.push_back(
      {layout::section_row_directory, true, std::vector<std::byte>(directory_size(contents.cells.size()))});
  if (!contents.certificate.empty()) {
    sections.push_back({layout::section_certificate, false, encode_certificate(contents.certificate)});
  }
  if (!contents.settings.empty()) {
    const auto text = std::as_bytes(std::span(contents.settings));
    sections.push_back({layout::section_settings, false, {text.begin(), text.end()}});
  }
  return sections;
}

std::vector<std::byte> encode_table(std::span<const section_bytes> front, std::span<const std::byte> rows) {
  std::vector<std::byte> bytes;
  byte_sink out(bytes);
  std::uint64_t offset = layout::header_size + (front.size() + 1) * layout::section_record_size;
  const auto put = [&](std::uint32_t id, bool required, std::span<const std::byte> section) {
    out.put_u32(id);
    out.put_u32(required ? layout::section_required : 0);
    out.put_u64(offset);
    out.put_u64(section.size());
    out.put_u32(crc32c(section));
    out.put_u32(0);
    offset += section.size();
  };
  for (const section_bytes& s : front) put(s.id, s.required, s.bytes);
  put(layout::section_rows, true, rows);
  return bytes;
}

void put_header(const file_contents& contents, const row_facts& bounds, std::size_t section_count,
                std::uint64_t total_size, std::uint32_t table_checksum, std::vector<std::byte>& file) {
  byte_sink out(file);
  for (const std::uint8_t byte : layout::magic) out.put_u8(byte);
  out.put_u32(layout::version);
  out.put_u32(static_cast<std::uint32_t>(section_count));
  out.put_u64(total_size);
  for (const std::uint8_t byte : contents.facts.scene_fingerprint) out.put_u8(byte);
  out.put_u32(contents.facts.polygon_count);
  out.put_u32(static_cast<std::uint32_t>(contents.facts.layout));
  out.put_f32(contents.facts.margin);
  out.put_f32(contents.facts.max_pixel_error);
  out.put_f32(contents.facts.confidence);
  out.put_u32(contents.facts.repeatable ? 0 : layout::flag_not_repeatable);
  out.put_u32(static_cast<std::uint32_t>(contents.cells.size()));
  out.put_u32(static_cast<std::uint32_t>(contents.draws.size()));
  out.put_u32(bounds.run_bound);
  out.put_u32(bounds.range_bound);
  out.put_u64(0);
  out.put_u32(table_checksum);
  out.put_u32(crc32c(file));
}

// The rows are most of a file: they are encoded where they will lie, and what is before them is filled in afterwards.
status encode_file(const file_contents& contents, std::vector<std::byte>& out) {
  if (const status s = check_contents(contents); s != status::ok) return s;
  std::vector<section_bytes> sections = front_sections(contents);
  std::size_t rows_begin = layout::header_size + (sections.size() + 1) * layout::section_record_size;
  for (const section_bytes& s : sections) rows_begin += s.bytes.size();
  std::vector<std::byte> file(rows_begin);
  row_facts rows;
  if (const status s = encode_rows(contents, file, rows); s != status::ok) return s;
  for (section_bytes& s : sections) {
    if (s.id == layout::section_row_directory) s.bytes = std::move(rows.directory);
  }
  const std::vector<std::byte> table = encode_table(sections, std::span(file).subspan(rows_begin));
  std::vector<std::byte> front;
  put_header(contents, rows, sections.size() + 1, file.size(), crc32c(table), front);
  byte_sink sink(front);
  sink.put_bytes(table);
  for (const section_bytes& s : sections) sink.put_bytes(s.bytes);
  std::copy(front.begin(), front.end(), file.begin());
  out = std::move(file);
  return status::ok;
}

}  // namespace

cell_set_source sets_of(std::span<const std::vector<std::uint32_t>> sets) {
  return {sets.size(), [sets](std::uint32_t cell, std::vector<std::uint32_t>& set) {
            set = sets[cell];
            return status::ok;
          }};
}

status encode(const file_contents& contents, std::vector<std::byte>& out) {
#if defined(__cpp_exceptions)
  try {
    return encode_file(contents, out);
  } catch (const std::bad_alloc&) {
    return status::memory;
  } catch (const std::length_error&) {  // what a vector says above its largest size
    return status::memory;
  }
#else
  return encode_file(contents, out);
#endif
}

}  // namespace sightcell::format
