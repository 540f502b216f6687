#pragma once
// Images as a file has them, and their pixels.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sightcell::scene {

// An image that is decoded when its pixels are needed.
struct image {
  std::string name;                   // for messages
  std::vector<std::uint8_t> encoded;  // PNG or JPEG
};

struct image_pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 * width * height bytes, rows from the top
};

struct image_size {
  std::uint32_t width = 0, height = 0;  // pixels
};

// Returns the size that the header of an image states; nothing for other bytes than PNG and JPEG.
std::optional<image_size> size_of(const std::vector<std::uint8_t>& encoded);

// Decodes an image.
// side_limit: the largest width and height to decode, pixels.
// Returns nothing if the bytes are neither PNG nor JPEG, are damaged, or a side is longer than side_limit.
std::optional<image_pixels> decode(const image& source, std::uint32_t side_limit);

}  // namespace sightcell::scene
