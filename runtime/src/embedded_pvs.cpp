#include "embedded_pvs.h"

#include <cstdint>
#include <limits>
#include <string_view>

namespace sightcell::runtime {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67;   // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t bin_chunk = 0x004E4942;   // "BIN\0"

std::uint32_t glb_u32(std::span<const std::byte> bytes, std::size_t at) noexcept {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

// A position in a JSON text. Steps over values without recursion: a text may be nested as deeply as it likes. All
// functions return false at the end of the text and where it is not JSON; the position is of no use then.
class json_position {
 public:
  explicit json_position(std::string_view text) noexcept : text_(text) {}

  // From an object to the value of its first member with this name, which the text spells without escapes.
  bool to_member(std::string_view name) noexcept {
    if (!take('{')) return false;
    while (!take('}')) {
      std::string_view found;
      if (!take_string(found) || !take(':')) return false;
      if (found == name) return true;
      if (!skip_value()) return false;
      (void)take(',');
    }
    return false;
  }

  // From an array to one of its elements.
  bool to_element(std::uint64_t number) noexcept {
    if (!take('[')) return false;
    for (std::uint64_t i = 0; i < number; ++i)
      if (!skip_value() || !take(',')) return false;
    return true;
  }

  bool read_number(std::uint64_t& out) noexcept {
    skip_space();
    const std::size_t begin = at_;
    out = 0;
    for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) {
      if (out > std::numeric_limits<std::uint32_t>::max()) return false;  // longer than any .glb
      out = 10 * out + static_cast<std::uint64_t>(text_[at_] - '0');
    }
    return at_ > begin && (at_ == text_.size() || is_end_of_scalar(text_[at_]));
  }

 private:
  static bool is_space(char c) noexcept { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  static bool is_end_of_scalar(char c) noexcept { return is_space(c) || c == ',' || c == '}' || c == ']'; }

  void skip_space() noexcept {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }

  bool take(char c) noexcept {
    skip_space();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  // out: what is between the quotes.
  bool take_string(std::string_view& out) noexcept {
    if (!take('"')) return false;
    const std::size_t begin = at_;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\\') {
        ++at_;
      } else if (text_[at_] == '"') {
        out = {text_.data() + begin, at_ - begin};  // substr() may throw, which needs the C++ library
        ++at_;
        return true;
      }
    }
    at_ = text_.size();  // a backslash was the last character
    return false;
  }

  // Brackets are counted, whatever their shape.
  bool skip_value() noexcept {
    std::uint64_t depth = 0;
    do {
      skip_space();
      if (at_ == text_.size()) return false;
      const char c = text_[at_];
      if (c == '"') {
        std::string_view ignored;
        if (!take_string(ignored)) return false;
        continue;
      }
      ++at_;
      if (c == '{' || c == '[') {
        ++depth;
      } else if (c == '}' || c == ']') {
        if (depth == 0) return false;
        --depth;
      } else if (depth == 0) {
        if (c == ',' || c == ':') return false;
        while (at_ < text_.size() && !is_end_of_scalar(text_[at_])) ++at_;
      }
    } while (depth > 0);
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

struct glb_parts {
  std::string_view json;
  std::span<const std::byte> binary;
};

sightcell_status split_glb(std::span<const std::byte> bytes, glb_parts& out) noexcept {
  if (bytes.size() < 20) return SIGHTCELL_ERR_TRUNCATED;
  const std::uint32_t length = glb_u32(bytes, 8);
  if (length > bytes.size()) return SIGHTCELL_ERR_TRUNCATED;
  const std::span<const std::byte> file = bytes.first(length);
  bool first = true, has_binary = false;
  for (std::size_t at = 12; at < file.size();) {
    if (file.size() - at < 8) return SIGHTCELL_ERR_CORRUPT;
    const std::uint32_t size = glb_u32(file, at), kind = glb_u32(file, at + 4);
    at += 8;
    if (size > file.size() - at) return SIGHTCELL_ERR_CORRUPT;
    const std::span<const std::byte> chunk = file.subspan(at, size);
    if (first && kind != json_chunk) return SIGHTCELL_ERR_CORRUPT;
    if (first) out.json = {reinterpret_cast<const char*>(chunk.data()), chunk.size()};
    if (!first && !has_binary && kind == bin_chunk) {
      out.binary = chunk;
      has_binary = true;
    }
    first = false;
    at += size;
  }
  return first ? SIGHTCELL_ERR_CORRUPT : SIGHTCELL_OK;
}

// A view without the member has the value that glTF gives it.
bool number_of_view(const json_position& view, std::string_view name, std::uint64_t without,
                    std::uint64_t& out) noexcept {
  json_position place = view;
  out = without;
  return !place.to_member(name) || place.read_number(out);
}

}  // namespace

sightcell_status find_embedded_pvs(std::span<const std::byte> bytes, std::span<const std::byte>& out) noexcept {
  out = bytes;
  if (bytes.size() < 4 || glb_u32(bytes, 0) != glb_magic) return SIGHTCELL_OK;
  glb_parts parts;
  if (const sightcell_status s = split_glb(bytes, parts); s != SIGHTCELL_OK) return s;
  json_position named(parts.json);
  std::uint64_t number = 0;
  if (!named.to_member("extras") || !named.to_member("sightcell") || !named.to_member("pvs") ||
      !named.to_member("bufferView"))
    return SIGHTCELL_ERR_ABSENT;
  if (!named.read_number(number)) return SIGHTCELL_ERR_CORRUPT;
  json_position view(parts.json);
  if (!view.to_member("bufferViews") || !view.to_element(number)) return SIGHTCELL_ERR_CORRUPT;
  std::uint64_t buffer = 0, offset = 0, length = 0;
  const bool read = number_of_view(view, "buffer", 1, buffer) && number_of_view(view, "byteOffset", 0, offset) &&
                    number_of_view(view, "byteLength", 0, length);
  if (!read || buffer != 0 || length == 0) return SIGHTCELL_ERR_CORRUPT;
  if (offset > parts.binary.size() || length > parts.binary.size() - offset) return SIGHTCELL_ERR_CORRUPT;
  out = parts.binary.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  return SIGHTCELL_OK;
}

}  // namespace sightcell::runtime
