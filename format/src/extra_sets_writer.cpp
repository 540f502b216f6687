#include "extra_sets_writer.h"

#include <algorithm>
#include <limits>

#include "byte_sink.h"
#include "checked_reader.h"
#include "packed_columns_writer.h"
#include "range_borders.h"
#include "record_rules.h"
#include "rows_encoder.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/layout.h"
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

}  // namespace

status encode_sets(const reader& file, const cell_set_source& sets, std::span<const certificate_record> certificate,
                   encoded_sets& out) {
  if (certificate.size() != sets.count || !std::all_of(certificate.begin(), certificate.end(), certificate_is_valid)) {
    return status::argument;
  }
  file_parts parts;
  if (const status s = take_apart(file, parts); s != status::ok) return s;
  parts.volumes.clear();
  parts.chunk_bytes = std::numeric_limits<std::uint32_t>::max();  // each block of 64 sets is a chunk
  const file_contents contents = parts.contents(sets);
  stored_sets stored(parts.draws, parts.order_of_draw, parts.orders, parts.facts.layout);
  rows_encoder rows(contents, stored, range_borders(contents.draws, contents.facts.layout));
  if (const status s = rows.plan(); s != status::ok) return s;
  std::vector<std::byte> encoded;
  std::vector<std::byte> directory;
  if (const status s = rows.write(encoded, directory); s != status::ok) return s;
  if (encoded.size() > layout::max_chunk_size) return status::limit;
  out = {rows.run_bound(), rows.list_bound(), {}};
  byte_sink sink(out.bytes);
  sink.put_bytes(encode_certificate(certificate));
  const std::vector<std::vector<std::uint32_t>> ends{chunk_ends(directory)};
  put_columns(ends, out.bytes);
  sink.put_bytes(rows.codes());
  sink.put_bytes(encoded);
  return status::ok;
}

}  // namespace sightcell::format
