#include "sightcell/format/caster_writer.h"

#include <algorithm>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "byte_sink.h"
#include "checked_reader.h"
#include "last_section.h"
#include "packed_columns_writer.h"
#include "range_borders.h"
#include "record_rules.h"
#include "rows_encoder.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "stored_sets.h"
#include "table_encoder.h"

namespace sightcell::format {
namespace {

// The end of each chunk in the rows, from the directory of the chunks.
std::vector<std::uint32_t> chunk_ends(std::span<const std::byte> directory) {
  std::vector<std::uint32_t> ends;
  const checked_reader in(directory);
  for (std::uint64_t at = 0; at < directory.size(); at += layout::chunk_record_size) {
    std::uint64_t offset = 0;
    std::uint32_t size = 0;
    if (in.read_u64(at, offset) && in.read_u32(at + 8, size)) ends.push_back(static_cast<std::uint32_t>(offset) + size);
  }
  return ends;
}

status encode_casters(const reader& file, const caster_source& source, std::vector<std::byte>& section) {
  const std::uint64_t suns = source.suns.size();
  const std::uint64_t sets = file.cell_count() * suns;
  if (suns == 0 || source.certificate.size() != sets) return status::argument;
  if (suns > layout::max_suns || sets > layout::max_caster_sets) return status::limit;
  if (!std::all_of(source.certificate.begin(), source.certificate.end(), certificate_is_valid)) {
    return status::argument;
  }
  file_parts parts;
  if (const status s = take_apart(file, parts); s != status::ok) return s;
  parts.volumes.clear();
  parts.chunk_bytes = std::numeric_limits<std::uint32_t>::max();  // each block of 64 sets is a chunk
  const file_contents contents =
      parts.contents({static_cast<std::size_t>(sets), [&](std::uint32_t set, std::vector<std::uint32_t>& ids) {
                        const auto of_cell = static_cast<std::uint32_t>(suns);
                        return source.get(set / of_cell, set % of_cell, ids);
                      }});
  stored_sets stored(parts.draws, parts.order_of_draw, parts.orders, parts.facts.layout);
  rows_encoder rows(contents, stored, range_borders(contents.draws, contents.facts.layout));
  if (const status s = rows.plan(); s != status::ok) return s;
  std::vector<std::byte> encoded;
  std::vector<std::byte> directory;
  if (const status s = rows.write(encoded, directory); s != status::ok) return s;
  if (encoded.size() > layout::max_chunk_size) return status::limit;

  byte_sink out(section);
  out.put_u32(static_cast<std::uint32_t>(suns));
  out.put_u32(rows.run_bound());
  out.put_u32(rows.list_bound());
  for (const sun_record& sun : source.suns) {
    for (const std::array<float, 3>* direction : {&sun.from, &sun.to}) {
      for (const float value : *direction) out.put_f32(value);
    }
  }
  out.put_bytes(encode_certificate(source.certificate));
  const std::vector<std::vector<std::uint32_t>> ends{chunk_ends(directory)};
  put_columns(ends, section);
  out.put_bytes(rows.codes());
  out.put_bytes(encoded);
  return status::ok;
}

status put_section_of(std::span<const std::byte> bytes, const caster_source* source, std::vector<std::byte>& out) {
  reader file;
  if (const status s = reader::open(bytes, file); s != status::ok) return s;
  if (source == nullptr) return with_last_section(file, bytes, layout::section_casters, std::nullopt, out);
  if (file.format_version() != layout::version) return status::version;
  std::vector<std::byte> section;
  if (const status s = encode_casters(file, *source, section); s != status::ok) return s;
  std::vector<std::byte> made;
  const status s = with_last_section(file, bytes, layout::section_casters, std::span<const std::byte>(section), made);
  if (s != status::ok) return s;
  // The rules of directions and bounds are those of the reader.
  reader again;
  caster_table table;
  if (reader::open(made, again) != status::ok || caster_table::open(again, table) != status::ok)
    return status::argument;
  out = std::move(made);
  return status::ok;
}

status put_or_tell(std::span<const std::byte> bytes, const caster_source* source, std::vector<std::byte>& out) {
#if defined(__cpp_exceptions)
  try {
    return put_section_of(bytes, source, out);
  } catch (const std::bad_alloc&) {
    return status::memory;
  } catch (const std::length_error&) {  // thrown by a vector above its largest size
    return status::memory;
  }
#else
  return put_section_of(bytes, source, out);
#endif
}

}  // namespace

status put_casters(std::span<const std::byte> file, const caster_source& casters, std::vector<std::byte>& out) {
  return put_or_tell(file, &casters, out);
}

status remove_casters(std::span<const std::byte> file, std::vector<std::byte>& out) {
  return put_or_tell(file, nullptr, out);
}

}  // namespace sightcell::format
