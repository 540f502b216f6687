#pragma once
// Triangles of an edit, to be asked whether a line passes one of them.
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "sightcell/base/box.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// A binary tree of boxes. It is read-only, so threads may share it.
class triangle_tree {
 public:
  triangle_tree() = default;  // of no triangles
  // near: meters. A line passes a triangle if a point of it is that close. O(n log n) for n triangles.
  triangle_tree(std::vector<triangle> triangles, float near);

  bool empty() const { return triangles_.empty(); }
  // Returns whether a line passes a triangle. Rounding, and lines that come close to a corner, may make it true where
  // none is as close as near; it is never false where one is.
  // length: of the line, in units of direction.
  bool passes(const glm::vec3& start, const glm::vec3& direction,
              float length = std::numeric_limits<float>::max()) const;

 private:
  struct node {
    box around;
    std::uint32_t first = 0, count = 0;  // of the triangles; count 0: the children are the next node and node `first`
  };
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<triangle> triangles_;
  std::vector<node> nodes_;
  float near_ = 0.0f;
};

}  // namespace sightcell::bake
