#include "report/data_uri.h"

#include <webp/encode.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <string_view>

namespace sightcell::cli {
namespace {

constexpr float webp_quality = 78.0f;

std::string base64_of(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t there = std::min<std::size_t>(3, size - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < there ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= there ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

picture::image_rgba halved(const picture::image_rgba& p) {
  picture::image_rgba out{std::max(p.width / 2, 1u), std::max(p.height / 2, 1u), {}};
  out.pixels.resize(4 * std::size_t{out.width} * out.height);
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x)
      for (std::size_t channel = 0; channel < 4; ++channel) {
        std::uint32_t sum = 2;
        for (const std::array<std::uint32_t, 2> d : {std::array{0u, 0u}, {1u, 0u}, {0u, 1u}, {1u, 1u}}) {
          const std::size_t from_x = std::min(2 * x + d[0], p.width - 1), from_y = std::min(2 * y + d[1], p.height - 1);
          sum += p.pixels[4 * (from_y * p.width + from_x) + channel];
        }
        out.pixels[4 * (std::size_t{y} * out.width + x) + channel] = static_cast<std::uint8_t>(sum / 4);
      }
  return out;
}

}  // namespace

std::string data_uri_of(const picture::image_rgba& picture) {
  WebPConfig config;
  WebPPicture encoded;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&encoded) == 0) throw std::bad_alloc();
  config.quality = webp_quality;
  encoded.use_argb = 1;
  encoded.width = static_cast<int>(picture.width), encoded.height = static_cast<int>(picture.height);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  encoded.writer = WebPMemoryWrite;
  encoded.custom_ptr = &writer;
  const std::unique_ptr<WebPPicture, void (*)(WebPPicture*)> free_picture(&encoded, WebPPictureFree);
  const std::unique_ptr<WebPMemoryWriter, void (*)(WebPMemoryWriter*)> free_writer(&writer, WebPMemoryWriterClear);
  if (WebPPictureImportRGBX(&encoded, picture.pixels.data(), 4 * encoded.width) == 0 ||
      WebPEncode(&config, &encoded) == 0)
    throw std::bad_alloc();
  return "data:image/webp;base64," + base64_of(writer.mem, writer.size);
}

picture::image_rgba halved_to(picture::image_rgba picture, std::uint32_t longest) {
  while (std::max(picture.width, picture.height) > std::max(longest, 1u)) picture = halved(picture);
  return picture;
}

}  // namespace sightcell::cli
