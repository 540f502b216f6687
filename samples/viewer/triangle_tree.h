#pragma once
// Rays and spheres against the triangles of a scene, for walking in it and for finding where there is something to see.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace viewer {

// A tree of boxes over triangles. Both sides of a triangle are hit. Const functions may be called from any thread.
class triangle_tree {
 public:
  // positions: in world space, meters. indices: three per triangle. Both must outlive the tree.
  // Triangles without area or with a corner that is not finite are left out.
  // Cost: O(n log n), about a second per million triangles; 20 bytes per triangle.
  triangle_tree(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

  // Returns the distance to the first triangle, or nothing if there is none within reach.
  // direction: of length 1. reach: in meters.
  std::optional<float> cast(const glm::vec3& from, const glm::vec3& direction, float reach) const;

  // Returns the point of the triangles that is nearest to a center, or nothing if none is nearer than radius (meters).
  std::optional<glm::vec3> nearest(const glm::vec3& center, float radius) const;

 private:
  struct node {
    glm::vec3 min, max;
    std::uint32_t first = 0;  // triangle in order_, or the right child; the left child follows its parent
    std::uint32_t count = 0;  // of triangles; 0 for an inner node
  };
  void build(std::uint32_t begin, std::uint32_t end, std::span<const glm::vec3> centers);
  glm::vec3 corner(std::uint32_t triangle, std::uint32_t k) const { return positions_[indices_[3 * triangle + k]]; }

  std::span<const glm::vec3> positions_;
  std::span<const std::uint32_t> indices_;
  std::vector<std::uint32_t> order_;
  std::vector<node> nodes_;
};

}  // namespace viewer
