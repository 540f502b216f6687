#include <cstdlib>
#include <string>

#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"

namespace sightcell::picture {

difference compare(const image_rgba& a, const image_rgba& b) {
  if (a.width != b.width || a.height != b.height || a.pixels.size() != b.pixels.size()) {
    throw error(error_kind::wrong_use, "picture.size", "pictures",
                std::to_string(a.width) + " x " + std::to_string(a.height) + " and " + std::to_string(b.width) + " x " +
                    std::to_string(b.height) + " pixels cannot be compared",
                "draw both at one size");
  }
  difference result;
  result.marked = a;
  std::uint64_t sum = 0;  // of all channels
  for (std::size_t at = 0; at + 3 < a.pixels.size(); at += 4) {
    unsigned differs = 0;
    for (std::size_t c = 0; c < 3; ++c) differs += static_cast<unsigned>(std::abs(a.pixels[at + c] - b.pixels[at + c]));
    sum += differs;
    result.differing_pixels += differs != 0 ? 1u : 0u;

    std::uint8_t* out = &result.marked.pixels[at];
    // Rec. 709 luma, dimmed so that red is easy to see.
    const int gray = (54 * a.pixels[at] + 183 * a.pixels[at + 1] + 19 * a.pixels[at + 2]) / 320;
    out[0] = differs != 0 ? std::uint8_t{255} : static_cast<std::uint8_t>(gray);
    out[1] = out[2] = differs != 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(gray);
    out[3] = 255;
  }
  const std::size_t channels = a.pixels.size() / 4 * 3;
  if (channels > 0) result.color_error = static_cast<double>(sum) / (255.0 * static_cast<double>(channels));
  return result;
}

}  // namespace sightcell::picture
