#include "last_section.h"

#include <algorithm>
#include <utility>

#include "byte_sink.h"
#include "checksum.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {

namespace {

status with_section(const reader& file, std::span<const std::byte> bytes, std::uint32_t id, bool in_front,
                    std::optional<std::span<const std::byte>> section, std::vector<std::byte>& out) {
  struct part {
    std::uint32_t id = 0;
    std::uint32_t flags = 0;
    std::span<const std::byte> bytes;
  };
  std::vector<part> parts;
  std::uint64_t total = layout::header_size;
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    section_record s;
    if (const status outcome = file.section(i, s); outcome != status::ok) return outcome;
    if (s.id == id) continue;
    parts.push_back({s.id, s.required ? layout::section_required : 0,
                     bytes.subspan(static_cast<std::size_t>(s.offset), static_cast<std::size_t>(s.size))});
  }
  if (section) {
    auto at = parts.end();
    if (in_front) at = std::find_if(parts.begin(), parts.end(), [](const part& p) { return layout::is_bulk(p.id); });
    parts.insert(at, {id, 0, *section});
  }
  if (parts.size() > layout::max_sections) return status::limit;
  for (const part& p : parts) total += layout::section_record_size + p.bytes.size();

  std::vector<std::byte> table;
  byte_sink records(table);
  std::uint64_t offset = layout::header_size + parts.size() * layout::section_record_size;
  for (const part& p : parts) {
    records.put_u32(p.id);
    records.put_u32(p.flags);
    records.put_u64(offset);
    records.put_u64(p.bytes.size());
    records.put_u32(crc32c(p.bytes));
    records.put_u32(0);
    offset += p.bytes.size();
  }
  std::vector<std::byte> made;
  made.reserve(static_cast<std::size_t>(total));
  byte_sink sink(made);
  const auto kept = [&](std::uint64_t from, std::uint64_t to) {
    sink.put_bytes(bytes.subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(to - from)));
  };
  kept(0, layout::header_section_count);
  sink.put_u32(static_cast<std::uint32_t>(parts.size()));
  sink.put_u64(total);
  kept(layout::header_fingerprint, layout::header_table_checksum);
  sink.put_u32(crc32c(table));
  sink.put_u32(crc32c(made));
  sink.put_bytes(table);
  for (const part& p : parts) sink.put_bytes(p.bytes);
  out = std::move(made);
  return status::ok;
}

}  // namespace

status with_last_section(const reader& file, std::span<const std::byte> bytes, std::uint32_t id,
                         std::optional<std::span<const std::byte>> last, std::vector<std::byte>& out) {
  return with_section(file, bytes, id, false, last, out);
}

status with_front_section(const reader& file, std::span<const std::byte> bytes, std::uint32_t id,
                          std::optional<std::span<const std::byte>> section, std::vector<std::byte>& out) {
  return with_section(file, bytes, id, true, section, out);
}

}  // namespace sightcell::format
