#include "difference.h"

#include <algorithm>
#include <cmath>

namespace engine_hook {
namespace {

bool same_place(float a, float b) {
  if (a == b) return true;
  if (a == 0.0f || b == 0.0f) return false;
  const float distance = near_plane / a;
  return std::abs(distance - near_plane / b) <= std::max(2e-4f, 2e-5f * distance);
}

}  // namespace

difference compare(const picture& reference, const picture& other) {
  difference out;
  for (std::size_t i = 0; i < reference.depths.size(); ++i) {
    if (!same_place(reference.depths[i], other.depths[i]) || reference.layers[i] != other.layers[i]) {
      ++out.differing;
    } else if (reference.surfaces[i] != other.surfaces[i]) {
      ++out.ties;
    }
  }
  return out;
}

}  // namespace engine_hook
