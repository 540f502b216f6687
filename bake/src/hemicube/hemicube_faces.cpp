#include "hemicube/hemicube_faces.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "sightcell/base/error.h"

namespace sightcell::bake {

std::array<face_view, face_count> hemicube_faces(const pose& where, std::uint32_t resolution) {
  const std::uint32_t s = resolution, h = resolution / 2;
  const glm::vec3 &f = where.forward, &r = where.right, &u = where.up;
  std::array<face_view, face_count> faces;
  faces[face_front] = {f, r, u, -1, 1, -1, 1, 0, 0, s, s};
  faces[face_right] = {r, -f, u, -1, 0, -1, 1, s + h, 0, h, s};
  faces[face_left] = {-r, f, u, 0, 1, -1, 1, s, 0, h, s};
  faces[face_up] = {u, r, -f, -1, 1, -1, 0, 2 * s, h, s, h};
  faces[face_down] = {-u, r, f, -1, 1, 0, 1, 2 * s, 0, s, h};
  return faces;
}

void check_hemicube(std::uint32_t resolution, float far_plane) {
  if (resolution % 2 != 0 || resolution < 16 || resolution > 4096)
    throw error(error_kind::wrong_use, "hemicube.resolution", "hemicube resolution " + std::to_string(resolution),
                "it must be even, from 16 to 4096", "choose another --resolution");
  if (!(far_plane > hemicube_near) || !std::isfinite(far_plane))
    throw error(error_kind::bad_input, "hemicube.far-plane", "scene",
                "its box is " + std::to_string(far_plane) + " m across, which is too small or too large to be drawn",
                "export it in meters");
}

glm::vec3 pixel_direction(const pose& where, std::uint32_t resolution, std::uint32_t pixel) {
  const std::uint32_t x = pixel % (3 * resolution), y = pixel / (3 * resolution);
  for (const face_view& face : hemicube_faces(where, resolution)) {
    if (x < face.x || x >= face.x + face.width || y < face.y || y >= face.y + face.height) continue;
    const auto part = [](std::uint32_t at, std::uint32_t first, std::uint32_t size, float low, float high) {
      return low + (static_cast<float>(at - first) + 0.5f) / static_cast<float>(size) * (high - low);
    };
    return glm::normalize(face.forward + part(x, face.x, face.width, face.min_x, face.max_x) * face.right +
                          part(y, face.y, face.height, face.min_y, face.max_y) * face.up);
  }
  return where.forward;  // the atlas has no such pixel
}

}  // namespace sightcell::bake
