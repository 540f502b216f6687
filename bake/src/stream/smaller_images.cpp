#include "stream/smaller_images.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <optional>

#include "stream/reduced_pixels.h"

namespace sightcell::bake {
namespace {

// Of the longest side, in pixels. Four times as many take about ten times the bytes.
constexpr std::array<std::uint32_t, 3> version_sides = {1024, 256, 64};
constexpr std::uint32_t decoded_side_limit = 8192;
// A version is written if it saves half of the next larger one, and more than a request costs.
constexpr std::size_t least_bytes_saved = 1024;
// At 85, versions of 64 pixels take a third more bytes; at 60, a tenth less.
constexpr float quality = 75.0f;

std::optional<scene::image_size> webp_size(const std::vector<std::uint8_t>& bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK || features.has_animation != 0)
    return std::nullopt;
  return scene::image_size{static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height)};
}

std::optional<scene::image_pixels> webp_pixels(const std::vector<std::uint8_t>& bytes) {
  const std::optional<scene::image_size> size = webp_size(bytes);
  if (!size || size->width > decoded_side_limit || size->height > decoded_side_limit) return std::nullopt;
  scene::image_pixels out{size->width, size->height, {}};
  out.rgba.resize(4 * std::size_t{size->width} * size->height);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), out.rgba.data(), out.rgba.size(),
                         static_cast<int>(4 * size->width)) == nullptr)
    return std::nullopt;
  return out;
}

// Returns a WebP file.
std::vector<std::uint8_t> webp_of(const scene::image_pixels& pixels, bool has_alpha) {
  WebPConfig config;
  WebPPicture picture;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0) throw std::bad_alloc();
  config.quality = quality;
  config.method = 6;  // smallest files
  config.use_sharp_yuv = 1;
  config.exact = 1;  // clients filter colors beside transparent pixels, too
  picture.use_argb = 1;
  picture.width = static_cast<int>(pixels.width), picture.height = static_cast<int>(pixels.height);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const std::unique_ptr<WebPPicture, void (*)(WebPPicture*)> free_picture(&picture, WebPPictureFree);
  const std::unique_ptr<WebPMemoryWriter, void (*)(WebPMemoryWriter*)> free_writer(&writer, WebPMemoryWriterClear);
  const auto import = has_alpha ? WebPPictureImportRGBA : WebPPictureImportRGBX;
  if (import(&picture, pixels.rgba.data(), 4 * picture.width) == 0 || WebPEncode(&config, &picture) == 0)
    throw std::bad_alloc();
  return {writer.mem, writer.mem + writer.size};
}

std::uint32_t scaled(std::uint32_t side, std::uint32_t longest, std::uint32_t to) {
  return std::max(1u, static_cast<std::uint32_t>((std::uint64_t{side} * to + longest / 2) / longest));
}

}  // namespace

smaller_images smaller_images_of(const scene::streamed_image& image) {
  using scene::image_type;
  smaller_images out{image.width, image.height, {}, false};
  if (image.type == image_type::ktx2 || image.type == image_type::unknown) return out;
  const bool is_webp = image.type == image_type::webp;
  if (is_webp)
    if (const auto size = webp_size(image.bytes)) out.width = size->width, out.height = size->height;
  if (image.bytes.size() <= least_bytes_saved) return out;
  const std::optional<scene::image_pixels> pixels =
      is_webp ? webp_pixels(image.bytes) : scene::decode({"", image.bytes}, decoded_side_limit);
  if (!pixels) {
    out.is_unreadable = true;
    return out;
  }
  std::size_t next_bytes = image.bytes.size();
  const std::uint32_t longest = std::max(pixels->width, pixels->height);
  for (const std::uint32_t side : version_sides) {
    if (side >= longest) continue;
    const scene::image_pixels fewer =
        reduced(*pixels, scaled(pixels->width, longest, side), scaled(pixels->height, longest, side), image.use);
    smaller_image version{fewer.width, fewer.height, webp_of(fewer, image.use.alpha != scene::alpha_use::none)};
    if (2 * version.bytes.size() > next_bytes || version.bytes.size() + least_bytes_saved > next_bytes) continue;
    next_bytes = version.bytes.size();
    out.versions.insert(out.versions.begin(), std::move(version));
  }
  return out;
}

}  // namespace sightcell::bake
