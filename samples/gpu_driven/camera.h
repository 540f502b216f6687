#pragma once
// A camera, and what shaders need of it. Depth is reversed and has no far plane.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gpu_records.h"

namespace gpu_driven {

// Meters. Its corners must be nearer to the eye than surfaces are to a valid viewpoint (sightcell_info.player_radius).
inline constexpr float near_plane = 0.001f;

// yaw: radians, 0 along -Z, to the left. pitch: radians, up.
struct camera {
  glm::vec3 eye{0.0f};
  float yaw = 0.0f, pitch = 0.0f;
};

// haze: meters.
inline camera_record record_of(const camera& c, float width, float height, float haze) {
  const glm::vec3 forward(-std::sin(c.yaw) * std::cos(c.pitch), std::sin(c.pitch),
                          -std::cos(c.yaw) * std::cos(c.pitch));
  const glm::vec3 right(std::cos(c.yaw), 0.0f, -std::sin(c.yaw)), up = glm::cross(right, forward);
  const float tan_y = 0.58f, tan_x = tan_y * width / height;  // of half the field of view
  const auto plane = [](const glm::vec3& n) { return glm::vec4(glm::normalize(n), 0.0f); };
  return {.eye = glm::vec4(c.eye, near_plane),
          .clip_x = glm::vec4(right / tan_x, 1.0f / haze),
          .clip_y = glm::vec4(up / tan_y, 0.0f),
          .clip_w = glm::vec4(forward, 0.0f),
          .planes = {plane(tan_x * forward + right), plane(tan_x * forward - right), plane(tan_y * forward + up),
                     plane(tan_y * forward - up), plane(forward)},
          .size = glm::vec4(width, height, 2.0f * tan_y / height, 0.0f)};
}

}  // namespace gpu_driven
