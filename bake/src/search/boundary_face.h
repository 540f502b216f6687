#pragma once
// One of the six faces of a cell's grown box, from which hemicubes look outward.
#include <array>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "hemicube/hemicube_source.h"

namespace sightcell::bake {

struct boundary_face {
  glm::vec3 corner{0.0f};           // the point u = v = 0
  glm::vec3 right{0.0f}, up{0.0f};  // unit vectors of u and v, the image axes of the hemicube
  glm::vec3 outward{0.0f};
  glm::vec2 size{0.0f};  // extent along u and v, meters

  // Returns the pose at uv in [0,1] x [0,1].
  pose at(const glm::vec2& uv) const {
    return {corner + right * (uv.x * size.x) + up * (uv.y * size.y), outward, right, up};
  }
};

// Returns the faces in the order -x, +x, -y, +y, -z, +z.
inline std::array<boundary_face, 6> faces_of(const glm::vec3& min, const glm::vec3& max) {
  std::array<boundary_face, 6> faces;
  const glm::vec3 extent = max - min;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      boundary_face& face = faces[static_cast<std::size_t>(2 * axis + side)];
      face.outward[axis] = side == 0 ? -1.0f : 1.0f;
      face.up = axis == 1 ? glm::vec3{0.0f, 0.0f, 1.0f} : glm::vec3{0.0f, 1.0f, 0.0f};
      face.right = glm::cross(face.outward, face.up);
      face.size = {glm::dot(glm::abs(face.right), extent), glm::dot(face.up, extent)};
      // The corner from which right and up point into the face.
      for (int k = 0; k < 3; ++k) {
        const float along = face.outward[k] + face.right[k] * -1.0f + face.up[k] * -1.0f;
        face.corner[k] = along > 0.0f ? max[k] : min[k];
      }
    }
  return faces;
}

}  // namespace sightcell::bake
