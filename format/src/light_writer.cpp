#include "sightcell/format/light_writer.h"

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

void put_light(const light_record& light, byte_sink& out) {
  out.put_u32(light.node);
  for (const float value : light.position) out.put_f32(value);
  for (const float value : light.direction) out.put_f32(value);
  out.put_f32(light.range);
  out.put_f32(light.cone);
}

void put_touching(const light_source& source, std::uint32_t cell, byte_sink& out) {
  const auto lights = static_cast<std::uint32_t>(source.lights.size());
  for (std::uint32_t first = 0; first < lights; first += 8) {
    unsigned eight = 0;
    for (std::uint32_t i = 0; i < 8 && first + i < lights; ++i) {
      if (source.touches(cell, first + i)) eight |= 1u << i;
    }
    out.put_u8(static_cast<std::uint8_t>(eight));
  }
}

status encode_lights(const reader& file, const light_source& source, std::vector<std::byte>& section) {
  if (source.lights.empty() || source.sets.count != source.lights.size() || !source.touches) return status::argument;
  if (source.lights.size() > layout::max_lights) return status::limit;
  encoded_sets encoded;
  if (const status s = encode_sets(file, source.sets, source.certificate, encoded); s != status::ok) return s;
  byte_sink out(section);
  out.put_u32(static_cast<std::uint32_t>(source.lights.size()));
  out.put_u32(encoded.run_bound);
  out.put_u32(encoded.list_bound);
  for (const light_record& light : source.lights) put_light(light, out);
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) put_touching(source, cell, out);
  out.put_bytes(encoded.bytes);
  return status::ok;
}

status put_lights_of(std::span<const std::byte> bytes, const light_source* source, std::vector<std::byte>& out) {
  reader file;
  if (const status s = reader::open(bytes, file); s != status::ok) return s;
  if (source == nullptr) return with_last_section(file, bytes, layout::section_lights, std::nullopt, out);
  if (file.format_version() != layout::version) return status::version;
  std::vector<std::byte> section;
  if (const status s = encode_lights(file, *source, section); s != status::ok) return s;
  std::vector<std::byte> made;
  const status s = with_last_section(file, bytes, layout::section_lights, std::span<const std::byte>(section), made);
  if (s != status::ok) return s;
  // The rules of numbers and bounds are those of the reader.
  reader again;
  light_table table;
  if (reader::open(made, again) != status::ok || light_table::open(again, table) != status::ok) return status::argument;
  out = std::move(made);
  return status::ok;
}

}  // namespace

status put_lights(std::span<const std::byte> file, const light_source& lights, std::vector<std::byte>& out) {
  return or_memory([&] { return put_lights_of(file, &lights, out); });
}

status remove_lights(std::span<const std::byte> file, std::vector<std::byte>& out) {
  return or_memory([&] { return put_lights_of(file, nullptr, out); });
}

}  // namespace sightcell::format
