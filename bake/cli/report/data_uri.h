#pragma once
// Pictures inside a page.
#include <string>

#include "sightcell/picture/picture.h"

namespace sightcell::cli {

// Returns a picture as a data URI of a lossy WebP file. Alpha is ignored.
// picture: of 1 x 1 to 16383 x 16383 pixels.
// Fails with std::bad_alloc if memory is short.
std::string data_uri_of(const picture::image_rgba& picture);

// Returns a picture of half the width and height, of means of 2 x 2 pixels, as often as needed until its longer side is
// at most `longest` pixels. A side of 1 pixel stays.
picture::image_rgba halved_to(picture::image_rgba picture, std::uint32_t longest);

}  // namespace sightcell::cli
