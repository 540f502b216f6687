#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "sightcell/scene/image.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#include <stb_image.h>

namespace sightcell::scene {
namespace {

// Returns whether this many bytes can contain this many pixels, so that a damaged header does not make the decoder
// allocate gigabytes. Deflate yields up to 1032 bytes from one; JPEG uses one bit or more per block of 64 pixels.
bool can_hold(const std::vector<std::uint8_t>& encoded, std::uint64_t pixels) {
  constexpr std::uint64_t free_pixels = std::uint64_t{1} << 16;
  const bool is_png = encoded[0] == 0x89;
  std::uint64_t pixels_per_byte = 512;
  if (is_png && encoded.size() > 25) {
    static constexpr std::array<std::uint64_t, 8> channels = {1, 1, 3, 1, 2, 1, 4, 1};  // by color type
    const std::uint64_t bits = std::max<std::uint64_t>(encoded[24], 1) * channels[encoded[25] % channels.size()];
    pixels_per_byte = std::uint64_t{1032} * 8 / bits;
  }
  return pixels <= free_pixels + encoded.size() * pixels_per_byte;
}

// Returns whether the file contains the bytes that its chunks state, because the decoder allocates them before it
// checks.
bool chunks_are_there(const std::vector<std::uint8_t>& png) {
  constexpr std::size_t signature = 8, head = 8, checksum = 4;
  for (std::size_t at = signature; png.size() - at >= head;) {
    const std::uint64_t length = std::uint64_t{png[at]} << 24 | std::uint64_t{png[at + 1]} << 16 |
                                 std::uint64_t{png[at + 2]} << 8 | std::uint64_t{png[at + 3]};
    const std::uint64_t left = png.size() - at - head;
    if (length > left) return false;
    if (left - length < checksum) break;
    at += head + static_cast<std::size_t>(length) + checksum;
  }
  return true;
}

}  // namespace

std::optional<image_size> size_of(const std::vector<std::uint8_t>& encoded) {
  if (encoded.empty() || encoded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return std::nullopt;
  const auto bytes = static_cast<int>(encoded.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(encoded.data(), bytes, &width, &height, &channels) == 0) return std::nullopt;
  if (width < 1 || height < 1) return std::nullopt;
  return image_size{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

std::optional<image_pixels> decode(const image& source, std::uint32_t side_limit) {
  const std::optional<image_size> size = size_of(source.encoded);
  if (!size || size->width > side_limit || size->height > side_limit) return std::nullopt;
  if (!can_hold(source.encoded, std::uint64_t{size->width} * size->height)) return std::nullopt;
  if (source.encoded[0] == 0x89 && !chunks_are_there(source.encoded)) return std::nullopt;
  const auto bytes = static_cast<int>(source.encoded.size());
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(source.encoded.data(), bytes, &width, &height, &channels, 4), stbi_image_free);
  if (!pixels) return std::nullopt;
  image_pixels out{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  out.rgba.assign(pixels.get(), pixels.get() + 4 * std::size_t{out.width} * out.height);
  return out;
}

}  // namespace sightcell::scene
