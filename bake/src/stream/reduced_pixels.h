#pragma once
// Images with fewer pixels, for a first view.
#include <cstdint>

#include "sightcell/scene/image.h"
#include "sightcell/scene/stream_pages.h"

namespace sightcell::bake {

// Returns an image whose pixels are means over their area of the source. Means of colors are those of light. Colors
// weigh as much as their alpha where this is coverage. Where alpha is tested, it is scaled so that the same part of the
// pixels passes. Vectors have length 1 again.
// width, height: at least 1 and at most those of the source.
scene::image_pixels reduced(const scene::image_pixels& source, std::uint32_t width, std::uint32_t height,
                            const scene::image_use& use);

}  // namespace sightcell::bake
