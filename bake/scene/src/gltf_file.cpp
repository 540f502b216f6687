#include "gltf_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <system_error>

#include "json_object.h"

namespace sightcell::scene {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67;   // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t bin_chunk = 0x004E4942;   // "BIN\0"

std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

// Reads a regular file. A pipe would block, and a device may have no end.
// name: the scene, for messages. what: the resource, for messages.
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path, const std::string& name,
                                     const std::string& what, std::optional<std::uint64_t> size) {
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) {
    refuse(name, "scene.not-found", what + " does not exist or cannot be reached", "check the path");
  }
  if (!std::filesystem::is_regular_file(status)) {
    refuse(name, "scene.not-found", what + " is not a file", "give a .glb or .gltf file, with its resources beside it");
  }
  const std::uint64_t available = std::filesystem::file_size(path, code);
  if (code) refuse(name, "scene.read", what + " cannot be read: " + code.message(), "check its permissions");
  if (size && *size > available) {
    refuse(name, "scene.buffer-size",
           what + " needs " + std::to_string(*size) + " bytes but has " + std::to_string(available),
           "the file is cut short: copy or export it again");
  }
  std::vector<std::uint8_t> bytes(size.value_or(available));
  std::ifstream stream(path, std::ios::binary);
  if (!stream || (!bytes.empty() &&
                  !stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())))) {
    refuse(name, "scene.read", what + " cannot be read", "check its permissions");
  }
  return bytes;
}

// Splits by chunks. Chunks of unknown type are skipped, as the container format requires.
gltf_file split_glb(std::span<const std::uint8_t> bytes, const std::string& name) {
  const char* const remedy = "copy or export the file again";
  if (bytes.size() < 20) refuse(name, "scene.truncated", "the .glb ends inside its header", remedy);
  const std::uint32_t version = u32_at(bytes, 4);
  if (version != 2) {
    refuse(name, "scene.version", "the .glb has container version " + std::to_string(version) + ", only 2 is read",
           "export it as glTF 2.0");
  }
  gltf_file out;
  const std::uint32_t length = u32_at(bytes, 8);
  if (length > bytes.size()) {
    refuse(name, "scene.truncated",
           "the header of the .glb states " + std::to_string(length) + " bytes, but it has " +
               std::to_string(bytes.size()),
           remedy);
  }
  if (length < bytes.size()) out.warnings.push_back("bytes after the end of the .glb are ignored");
  bool first = true;
  for (std::size_t at = 12; at < length;) {
    if (length - at < 8) refuse(name, "scene.truncated", "the .glb ends inside a chunk header", remedy);
    const std::uint32_t chunk_length = u32_at(bytes, at);
    const std::uint32_t type = u32_at(bytes, at + 4);
    at += 8;
    if (chunk_length > length - at) refuse(name, "scene.truncated", "a chunk of the .glb ends after the file", remedy);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(chunk_length);
    if (first && type != json_chunk) refuse(name, "scene.not-gltf", "the first chunk of the .glb is not JSON", remedy);
    if (first) out.json.assign(begin, end);
    if (!first && type == bin_chunk && !out.binary) out.binary.emplace(begin, end);
    first = false;
    at += chunk_length;
  }
  if (first) refuse(name, "scene.truncated", "the .glb has no JSON chunk", remedy);
  return out;
}

std::optional<std::string> percent_decoded(const std::string& uri) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%' || i + 2 >= uri.size() || digit(uri[i + 1]) < 0 || digit(uri[i + 2]) < 0) {
      out += uri[i];
      continue;
    }
    out += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
    i += 2;
  }
  if (out.find('\0') != std::string::npos) return std::nullopt;
  return out;
}

// Returns the decoded bytes; nothing if the text is not base64. Padding and white space are accepted at the end only.
std::optional<std::vector<std::uint8_t>> base64_decoded(std::string_view text) {
  static constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::uint8_t, 256> value{};
  value.fill(255);
  for (std::size_t i = 0; i < alphabet.size(); ++i) {
    value[static_cast<unsigned char>(alphabet[i])] = static_cast<std::uint8_t>(i);
  }
  while (!text.empty() && (text.back() == '=' || text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  unsigned bit_count = 0;
  for (const char c : text) {
    const std::uint8_t v = value[static_cast<unsigned char>(c)];
    if (v == 255) return std::nullopt;
    bits = (bits << 6 | v) & 0xFFFFu;
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    out.push_back(static_cast<std::uint8_t>(bits >> bit_count));
  }
  return out;
}

std::vector<std::uint8_t> decode_data_uri(const std::string& uri, const std::string& name, const std::string& what,
                                          std::optional<std::uint64_t> size) {
  const std::size_t comma = uri.find(',');
  const std::string_view head = std::string_view(uri).substr(0, comma == std::string::npos ? uri.size() : comma);
  if (comma == std::string::npos || !head.ends_with(";base64")) {
    refuse(name, "scene.bad-field", what + " has a data URI that is not base64", "export the file again");
  }
  auto bytes = base64_decoded(std::string_view(uri).substr(comma + 1));
  if (!bytes) refuse(name, "scene.bad-field", what + " has a data URI that is not base64", "export the file again");
  if (size && *size > bytes->size()) {
    refuse(name, "scene.buffer-size",
           what + " needs " + std::to_string(*size) + " bytes but its data URI has " + std::to_string(bytes->size()),
           "export the file again");
  }
  if (size) bytes->resize(*size);
  return *std::move(bytes);
}

bool has_uri_scheme(const std::string& uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string::npos && uri.find('/') > colon;
}

// Returns the path of a relative URI from the scene's folder; nothing if it is outside. Lexical on purpose: a symbolic
// link was made by the user, "../.." comes from the file.
std::optional<std::filesystem::path> path_in_folder(const std::string& uri) {
  const auto decoded = percent_decoded(uri);
  std::filesystem::path relative = std::filesystem::path(decoded.value_or("")).lexically_normal();
  if (!decoded || relative.empty() || relative.is_absolute() || relative.has_root_name() || *relative.begin() == "..")
    return std::nullopt;
  return relative;
}

}  // namespace

gltf_source source_of(const std::filesystem::path& path) {
  return {printable(path.string(), 1000), path.parent_path()};
}

std::vector<std::uint8_t> read_scene_bytes(const std::filesystem::path& path) {
  return read_bytes(path, printable(path.string(), 1000), "the scene", std::nullopt);
}

gltf_file split_gltf(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) refuse(name, "scene.truncated", "the file is empty", "copy or export it again");
  if (bytes.size() >= 4 && u32_at(bytes, 0) == glb_magic) return split_glb(bytes, name);
  static constexpr std::string_view skipped = " \t\r\n\xEF\xBB\xBF";
  const auto first = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t b) {
    return skipped.find(static_cast<char>(b)) == std::string_view::npos;
  });
  if (first == bytes.end() || *first != '{') {
    refuse(name, "scene.not-gltf", "is neither a .glb nor glTF's JSON", "give a glTF 2.0 scene (.glb or .gltf)");
  }
  gltf_file out;
  out.json.assign(bytes.begin(), bytes.end());
  return out;
}

std::optional<std::filesystem::path> file_of_uri(const gltf_source& scene, const std::string& uri) {
  if (!scene.folder || has_uri_scheme(uri)) return std::nullopt;
  const auto relative = path_in_folder(uri);
  return relative ? std::optional(*scene.folder / *relative) : std::nullopt;
}

std::vector<std::uint8_t> read_resource(const gltf_source& scene, const std::string& uri, const std::string& what,
                                        std::optional<std::uint64_t> size) {
  const std::string& name = scene.name;
  if (uri.starts_with("data:")) return decode_data_uri(uri, name, what, size);
  if (has_uri_scheme(uri)) {
    refuse(name, "scene.outside-folder",
           what + " is at \"" + printable(uri) + "\", which is not a file beside the scene",
           "put it beside the scene and use a relative URI");
  }
  if (!scene.folder) {
    refuse(name, "scene.outside-folder",
           what + " is at \"" + printable(uri) + "\", but the scene is in memory and has no folder",
           "name the folder of its resources, or put them into the scene");
  }
  const auto relative = path_in_folder(uri);
  if (!relative) {
    refuse(name, "scene.outside-folder", what + " is at \"" + printable(uri) + "\", outside the scene's folder",
           "put it beside the scene and use a relative URI");
  }
  return read_bytes(*scene.folder / *relative, name, what + " (" + printable(uri) + ")", size);
}

}  // namespace sightcell::scene
