#include "compare.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "camera.h"

namespace vulkan_host {
namespace {

bool is_same_place(float a, float b) {
  if (a == b) return true;
  if (a == 0.0f || b == 0.0f) return false;
  const float distance = near_plane / a;
  return std::abs(distance - near_plane / b) <= std::max(2e-4f, 2e-5f * distance);
}

bool differs(const picture& a, const picture& b, std::size_t byte, int levels) {
  return std::abs(int{a.rgba[byte]} - int{b.rgba[byte]}) > levels;
}

}  // namespace

difference compare(const picture& reference, const picture& other) {
  difference out;
  for (std::size_t i = 0; i < reference.depths.size(); ++i) {
    const std::size_t at = 4 * i;
    // The alphas of blended polygons are added up, each rounded to a level.
    if (!is_same_place(reference.depths[i], other.depths[i]) || differs(reference, other, at + 3, 1)) {
      ++out.wrong;
    } else if (differs(reference, other, at, 8) || differs(reference, other, at + 1, 8) ||
               differs(reference, other, at + 2, 8)) {
      ++out.ties;
    }
  }
  return out;
}

}  // namespace vulkan_host
