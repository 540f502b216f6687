#pragma once
// Where a picture shows something else than that of everything.
#include <cstdint>

#include "target.h"

namespace vulkan_host {

struct difference {
  std::uint64_t wrong = 0;  // another place, or other blended polygons before it
  std::uint64_t ties = 0;   // another color in the same place: of surfaces that coincide, another one is in front
};

// Places are compared, not colors. A set needs only one of several surfaces in the same place, and the order of drawing
// decides which one is shown. The bake calls surfaces coincident that are no farther apart than max(0.2 mm, distance /
// 50,000). The same triangle under the same transform has bit for bit the same depth in all pictures.
difference compare(const picture& reference, const picture& other);

}  // namespace vulkan_host
