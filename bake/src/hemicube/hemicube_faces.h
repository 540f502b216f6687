#pragma once
// The five faces of a hemicube: their directions, the part of its image that each one keeps, and the place of this part
// in the atlas.
//
// The atlas is 3 S wide and S high, y up: front | left half, right half | up half above down half.
//   face   direction     image right   image up   keeps of the 90 degree image
//   front  forward       right         up         all
//   right  right         -forward      up         its left half
//   left   -right        forward       up         its right half
//   up     up            right         -forward   its lower half
//   down   -up           right         forward    its upper half
// So the right and left faces have the up axis of the pose, the up and down faces have its right axis, and each kept
// half touches the front face.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "hemicube/hemicube_source.h"

namespace sightcell::bake {

// Distance of the near plane, one millimeter: closer than a camera comes to any surface.
inline constexpr float hemicube_near = 0.001f;

struct face_view {
  glm::vec3 forward, right, up;
  // Kept part of the image plane at distance 1.
  float min_x, max_x, min_y, max_y;
  // Rectangle in the atlas, pixels from the lower left corner.
  std::uint32_t x, y, width, height;
};

enum : std::uint32_t { face_front = 0, face_right = 1, face_left = 2, face_up = 3, face_down = 4, face_count = 5 };

std::array<face_view, face_count> hemicube_faces(const pose& where, std::uint32_t resolution);

// Checks the options that all sources share. Throws sightcell::error where resolution is odd or not in 16..4096, and
// where far_plane is not finite or not beyond the near plane.
void check_hemicube(std::uint32_t resolution, float far_plane);

// Unit vector from the eye through the center of a pixel of the atlas, counted row by row from its lower left corner.
glm::vec3 pixel_direction(const pose& where, std::uint32_t resolution, std::uint32_t pixel);

}  // namespace sightcell::bake
