#pragma once
// Images as they lie in a file, and their pixels.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sightcell::scene {

// PNG or JPEG bytes; decoded only by who needs the pixels.
struct image {
  std::string name;
  std::vector<std::uint8_t> encoded;
};

struct image_pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 x width x height bytes, rows from the top
};

// Nothing when the bytes are neither PNG nor JPEG, are broken, or a side is longer than side_limit.
std::optional<image_pixels> decode(const image& source, std::uint32_t side_limit);

}  // namespace sightcell::scene
