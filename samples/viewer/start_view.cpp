#include "start_view.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numbers>

namespace viewer {
namespace {

constexpr std::size_t most_eyes = 48;
constexpr int directions = 48;
constexpr float longest = 10000.0f;  // meters
constexpr float aside = 0.03f;       // radians: a line through a slit is no view

}  // namespace

fly_camera best_view(const triangle_tree& scene, std::span<const glm::vec3> eyes) {
  fly_camera best;
  best.eye = eyes.front();
  float longest_line = 0.0f;
  const std::size_t step = (eyes.size() + most_eyes - 1) / most_eyes;
  for (std::size_t i = 0; i < eyes.size(); i += step) {
    fly_camera camera;
    camera.eye = eyes[i];
    for (int k = 0; k < directions; ++k) {
      const float yaw = 2.0f * std::numbers::pi_v<float> * static_cast<float>(k) / directions;
      float line = longest;
      for (const float turned : {-aside, 0.0f, aside}) {
        camera.yaw = yaw + turned;
        line = std::min(line, scene.cast(camera.eye, camera.forward(), longest).value_or(0.0f));
      }
      if (line <= longest_line) continue;
      longest_line = line;
      best = camera;
      best.yaw = yaw > std::numbers::pi_v<float> ? yaw - 2.0f * std::numbers::pi_v<float> : yaw;
    }
  }
  return best;
}

std::size_t nearest_eye(std::span<const glm::vec3> eyes, const glm::vec3& point) {
  const auto nearest = std::min_element(eyes.begin(), eyes.end(), [&](const glm::vec3& a, const glm::vec3& b) {
    return glm::distance(a, point) < glm::distance(b, point);
  });
  return static_cast<std::size_t>(nearest - eyes.begin());
}

}  // namespace viewer
