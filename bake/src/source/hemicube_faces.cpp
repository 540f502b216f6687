#include "source/hemicube_faces.h"

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

}  // namespace sightcell::bake
