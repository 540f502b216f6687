#pragma once
// Smaller versions of images, which clients load first (docs/streaming.md, "Images").
#include <cstdint>
#include <vector>

#include "sightcell/scene/stream_pages.h"

namespace sightcell::bake {

struct smaller_image {
  std::uint32_t width = 0, height = 0;  // pixels
  std::vector<std::uint8_t> bytes;      // WebP
};

struct smaller_images {
  std::uint32_t width = 0, height = 0;  // of the image itself; 0: unknown
  std::vector<smaller_image> versions;  // ascending
  bool is_unreadable = false;           // its type is known, but it is damaged or too large to decode
};

// Returns the versions that save enough bytes: none for types that cannot be decoded.
// Cost: memory for 8 bytes per pixel.
smaller_images smaller_images_of(const scene::streamed_image& image);

}  // namespace sightcell::bake
