#pragma once
// The size of an image of any format that glTF files have.
#include <cstdint>
#include <optional>
#include <span>

#include "sightcell/scene/image.h"

namespace sightcell::scene {

// Returns the size that the header of a PNG, JPEG, KTX2, WebP or DDS image states; nothing for other bytes.
std::optional<image_size> size_in_header(std::span<const std::uint8_t> bytes);

}  // namespace sightcell::scene
