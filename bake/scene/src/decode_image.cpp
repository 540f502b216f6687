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

std::optional<image_pixels> decode(const image& source, std::uint32_t side_limit) {
  if (source.encoded.empty() || source.encoded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return std::nullopt;
  const auto bytes = static_cast<int>(source.encoded.size());
  int width = 0, height = 0, channels = 0;
  // The size first: a broken header must not make the decoder allocate gigabytes.
  if (stbi_info_from_memory(source.encoded.data(), bytes, &width, &height, &channels) == 0) return std::nullopt;
  if (width < 1 || height < 1) return std::nullopt;
  if (static_cast<std::uint32_t>(width) > side_limit || static_cast<std::uint32_t>(height) > side_limit)
    return std::nullopt;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(source.encoded.data(), bytes, &width, &height, &channels, 4), stbi_image_free);
  if (!pixels) return std::nullopt;
  image_pixels out{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  out.rgba.assign(pixels.get(), pixels.get() + 4 * std::size_t{out.width} * out.height);
  return out;
}

}  // namespace sightcell::scene
