#include "glb_bytes.h"

namespace sightcell::scene {
namespace {

constexpr std::uint64_t glb_headers = 12 + 8 + 8;

void append_u32(std::vector<std::byte>& out, std::uint64_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>(value >> shift & 0xFFu));
}

void append_text(std::vector<std::byte>& out, const std::string& text) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(text.data());
  out.insert(out.end(), bytes, bytes + text.size());
}

}  // namespace

std::uint64_t glb_size(const std::string& json, std::uint64_t binary) {
  return glb_headers + (json.size() + 3) / 4 * 4 + binary;
}

std::vector<std::byte> glb_with_room(std::string json, std::uint64_t binary) {
  const std::uint64_t size = glb_size(json, binary);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<std::byte> out;
  out.reserve(size);
  append_text(out, "glTF");
  append_u32(out, 2);
  append_u32(out, size);
  append_u32(out, json.size());
  append_text(out, "JSON");
  append_text(out, json);
  append_u32(out, binary);
  append_text(out, std::string("BIN\0", 4));
  out.resize(size);
  return out;
}

}  // namespace sightcell::scene
