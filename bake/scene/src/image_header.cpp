#include "image_header.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace sightcell::scene {
namespace {

std::uint32_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

bool begins(std::span<const std::uint8_t> bytes, std::size_t at, std::string_view with) {
  if (at + with.size() > bytes.size()) return false;
  for (std::size_t i = 0; i < with.size(); ++i)
    if (bytes[at + i] != static_cast<std::uint8_t>(with[i])) return false;
  return true;
}

std::optional<image_size> webp_size(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t side_bits = 0x3FFF;
  if (begins(bytes, 12, "VP8X")) return image_size{number_at(bytes, 24, 3) + 1, number_at(bytes, 27, 3) + 1};
  if (begins(bytes, 12, "VP8 "))
    return image_size{number_at(bytes, 26, 2) & side_bits, number_at(bytes, 28, 2) & side_bits};
  if (!begins(bytes, 12, "VP8L")) return std::nullopt;
  const std::uint32_t sides = number_at(bytes, 21, 4);
  return image_size{(sides & side_bits) + 1, (sides >> 14 & side_bits) + 1};
}

}  // namespace

std::optional<image_size> size_in_header(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t longest_header = 30;
  std::optional<image_size> size;
  if (bytes.size() >= longest_header) {
    if (begins(bytes, 0, "\xABKTX 20\xBB")) size = image_size{number_at(bytes, 20, 4), number_at(bytes, 24, 4)};
    if (begins(bytes, 0, "DDS ")) size = image_size{number_at(bytes, 16, 4), number_at(bytes, 12, 4)};
    if (begins(bytes, 0, "RIFF") && begins(bytes, 8, "WEBP")) size = webp_size(bytes);
  }
  if (!size) size = size_of(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  if (size && (size->width == 0 || size->height == 0)) return std::nullopt;
  return size;
}

}  // namespace sightcell::scene
