#pragma once
// A person who walks through a scene: gravity, floors, steps and walls.
#include <glm/vec3.hpp>

#include "triangle_tree.h"

namespace viewer {

class walker {
 public:
  static constexpr float eye_height = 1.6f, radius = 0.3f, highest_step = 0.5f;  // meters

  // Returns where the eye is after a frame. Walls hold the body, steps lift it, and without a floor it falls. Where
  // nothing at all lies below, it keeps its height.
  // velocity: meters per second; its height does not count.
  // jump: whether a jump begins now, if the feet are on a floor.
  glm::vec3 move(const triangle_tree& scene, glm::vec3 eye, const glm::vec3& velocity, bool jump, float seconds);

  // Forgets the fall. For jumps of the camera.
  void reset() { *this = {}; }
  bool on_floor() const { return on_floor_; }

 private:
  void fall(const triangle_tree& scene, glm::vec3& eye, float seconds);

  float falling_ = 0.0f;  // meters per second, downward
  bool on_floor_ = false;
};

}  // namespace viewer
