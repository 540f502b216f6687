#pragma once
// What the camera has in view: which parts of a draw to leave out, and lines that show it from outside.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "controls.h"
#include "draw_lists.h"

namespace viewer {

// A line in space.
struct segment {
  glm::vec3 a, b;
  glm::vec4 color;  // linear, with alpha
};

void add_box(std::vector<segment>& lines, const glm::vec3& min, const glm::vec3& max, const glm::vec4& color);

// Four planes through the eye; there is no far one. A point p is outside if dot(normal, p - eye) < 0.
struct view_volume {
  glm::vec3 eye{0.0f};
  std::array<glm::vec3, 4> normals{};

  // aspect: width by height of the picture.
  view_volume(const fly_camera& camera, float aspect);
  // Returns false only if all of the box is outside of one plane.
  bool touches(const glm::vec3& min, const glm::vec3& max) const;
};

// The edges of what a camera has in view, up to a distance in meters.
void add_frustum(std::vector<segment>& lines, const fly_camera& camera, float aspect, float distance,
                 const glm::vec4& color);

// The boxes of a scene's polygons, some hundred at a time, in stored order.
class polygon_blocks {
 public:
  // stored_indices: into positions, three per polygon.
  polygon_blocks(std::span<const sightcell_draw> draws, std::span<const glm::vec3> positions,
                 std::span<const std::uint32_t> stored_indices);

  // Replaces out by what of the parts lies in blocks that the volume touches, in the same order.
  void clip(std::span<const list_part> parts, const view_volume& volume, std::vector<list_part>& out) const;

 private:
  struct block {
    glm::vec3 min, max;
  };
  std::vector<std::uint32_t> first_of_draw_;
  std::vector<block> blocks_;
};

}  // namespace viewer
