#include "sightcell/format/caster_writer.h"

#include <optional>
#include <utility>

#include "byte_sink.h"
#include "extra_sets_writer.h"
#include "last_section.h"
#include "memory_status.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"

namespace sightcell::format {
namespace {

status encode_casters(const reader& file, const caster_source& source, std::vector<std::byte>& section) {
  const std::uint64_t suns = source.suns.size();
  const std::uint64_t sets = file.cell_count() * suns;
  if (suns == 0 || source.certificate.size() != sets) return status::argument;
  if (suns > layout::max_suns || sets > layout::max_caster_sets) return status::limit;
  encoded_sets encoded;
  const cell_set_source all{static_cast<std::size_t>(sets), [&](std::uint32_t set, std::vector<std::uint32_t>& ids) {
                              const auto of_cell = static_cast<std::uint32_t>(suns);
                              return source.get(set / of_cell, set % of_cell, ids);
                            }};
  if (const status s = encode_sets(file, all, source.certificate, encoded); s != status::ok) return s;
  byte_sink out(section);
  out.put_u32(static_cast<std::uint32_t>(suns));
  out.put_u32(encoded.run_bound);
  out.put_u32(encoded.list_bound);
  for (const sun_record& sun : source.suns) {
    for (const std::array<float, 3>* direction : {&sun.from, &sun.to}) {
      for (const float value : *direction) out.put_f32(value);
    }
  }
  out.put_bytes(encoded.bytes);
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

}  // namespace

status put_casters(std::span<const std::byte> file, const caster_source& casters, std::vector<std::byte>& out) {
  return or_memory([&] { return put_section_of(file, &casters, out); });
}

status remove_casters(std::span<const std::byte> file, std::vector<std::byte>& out) {
  return or_memory([&] { return put_section_of(file, nullptr, out); });
}

}  // namespace sightcell::format
