#include "walker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace viewer {
namespace {

constexpr float gravity = 9.81f, jump_speed = 4.2f, fastest_fall = 50.0f;  // meters, seconds
constexpr float longest_stride = 0.15f;  // half of the radius: no wall is stepped through
constexpr float step_speed = 4.0f;       // with which steps lift the eye: a stair is a ramp to look at
constexpr float deepest_floor = 10000.0f;
constexpr glm::vec3 down(0.0f, -1.0f, 0.0f);

// The body above the highest step: three spheres on a vertical line.
constexpr float sphere_below_eye[] = {0.2f, 0.5f, walker::eye_height - walker::highest_step - walker::radius};

void push_out_of_walls(const triangle_tree& scene, glm::vec3& eye) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    bool touched = false;
    for (const float below : sphere_below_eye) {
      const glm::vec3 center = eye + below * down;
      const auto point = scene.nearest(center, walker::radius);
      if (!point) continue;
      glm::vec3 away = center - *point;
      const float distance = glm::length(away);
      away.y = 0.0f;
      const float level = glm::length(away);
      if (level < 1e-5f) continue;  // a floor or a ceiling
      // Far enough along the level for the sphere to touch the point and no more.
      const float height = center.y - point->y;
      const float wanted = std::sqrt(std::max(walker::radius * walker::radius - height * height, 0.0f));
      if (distance >= walker::radius || wanted <= level + 1e-4f) continue;
      eye += (wanted - level) / level * away;
      touched = true;
    }
    if (!touched) return;
  }
}

}  // namespace

glm::vec3 walker::move(const triangle_tree& scene, glm::vec3 eye, const glm::vec3& velocity, bool jump, float seconds) {
  const glm::vec3 way = seconds * glm::vec3(velocity.x, 0.0f, velocity.z);
  const int strides = std::max(1, static_cast<int>(std::ceil(glm::length(way) / longest_stride)));
  if (jump && on_floor_) {
    falling_ = -jump_speed;
    on_floor_ = false;
  }
  for (int i = 0; i < strides; ++i) {
    eye += way / static_cast<float>(strides);
    push_out_of_walls(scene, eye);
    fall(scene, eye, seconds / static_cast<float>(strides));
  }
  return eye;
}

void walker::fall(const triangle_tree& scene, glm::vec3& eye, float seconds) {
  const float above_step = eye_height - highest_step;
  const glm::vec3 knee = eye + above_step * down;
  if (falling_ < 0.0f) {  // a jump still rises, up to a ceiling
    const float rise = -falling_ * seconds;
    if (const auto ceiling = scene.cast(eye, -down, rise + radius)) {
      falling_ = 0.0f;
      eye.y += std::max(0.0f, std::min(rise, *ceiling - radius));
      return;
    }
    eye.y += rise;
    falling_ += gravity * seconds;
    return;
  }
  const auto floor = scene.cast(knee, down, deepest_floor);
  if (!floor) {
    falling_ = 0.0f;
    on_floor_ = false;
    return;
  }
  const float gap = *floor - highest_step;  // of the feet over the floor; less than 0 on a step
  if (gap <= (on_floor_ ? highest_step : falling_ * seconds + 1e-3f)) {
    eye.y -= on_floor_ ? std::clamp(gap, -step_speed * seconds, step_speed * seconds) : gap;
    on_floor_ = true;
    falling_ = 0.0f;
    return;
  }
  on_floor_ = false;
  falling_ = std::min(falling_ + gravity * seconds, fastest_fall);
  eye.y -= std::min(gap, falling_ * seconds);
}

}  // namespace viewer
