#pragma once
// A camera, and what shaders need of it. Depth is reversed and has no far plane.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gpu_records.h"

namespace vulkan_host {

// Meters. Its corners must be nearer to the eye than surfaces are to a valid viewpoint (sightcell_info.player_radius).
inline constexpr float near_plane = 0.01f;

struct camera {
  glm::vec3 eye{0.0f}, right{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f}, forward{0.0f, 0.0f, -1.0f};
  float tan_x = 1.0f, tan_y = 0.58f;  // of half the field of view

  // Normals of the planes of the frustum, all of which contain the eye, to the inside: four sides, and the plane
  // behind.
  std::array<glm::vec4, 5> planes() const {
    const auto plane = [](const glm::vec3& n) { return glm::vec4(glm::normalize(n), 0.0f); };
    return {plane(tan_x * forward + right), plane(tan_x * forward - right), plane(tan_y * forward + up),
            plane(tan_y * forward - up), plane(forward)};
  }

  // haze: meters.
  draw_constants constants(float haze) const {
    return {glm::vec4(eye, near_plane), glm::vec4(right / tan_x, 1.0f / haze),
            glm::vec4(-up / tan_y, 0.0f),  // Vulkan's y is down
            glm::vec4(forward, 0.0f)};
  }
};

// yaw: radians, 0 along -Z, to the left. pitch: radians, up.
inline camera look(const glm::vec3& eye, float yaw, float pitch, float aspect) {
  camera out;
  out.eye = eye;
  out.forward = {-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)};
  out.right = {std::cos(yaw), 0.0f, -std::sin(yaw)};
  out.up = glm::cross(out.right, out.forward);
  out.tan_x = out.tan_y * aspect;
  return out;
}

}  // namespace vulkan_host
