#include "triangle_modes.h"

namespace sightcell::scene {

std::vector<std::uint32_t> to_triangles(std::vector<std::uint32_t> corners, int mode) {
  if (mode == mode_triangles) {
    corners.resize(corners.size() / 3 * 3);
    return corners;
  }
  std::vector<std::uint32_t> out;
  if (corners.size() < 3) return out;
  out.reserve((corners.size() - 2) * 3);
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    const std::size_t odd = i % 2;
    if (mode == mode_triangle_strip) {
      out.insert(out.end(), {corners[i], corners[i + 1 + odd], corners[i + 2 - odd]});
    } else {
      out.insert(out.end(), {corners[0], corners[i + 1], corners[i + 2]});
    }
  }
  return out;
}

}  // namespace sightcell::scene
