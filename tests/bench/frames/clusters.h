#pragma once
// Clusters of polygons that lie close to each other, and which of them a camera's frustum touches. No OpenGL.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "bench/frames/baked_world.h"

namespace sightcell::bench {

// A pyramid without a far end.
struct frustum {
  glm::vec3 eye{0.0f};
  std::array<glm::vec3, 5> inward;  // normals of planes through the eye: left, right, bottom, top, and forward
};

// Boxes as middles and half sizes, eight of each at a time.
class box_lanes {
 public:
  static constexpr std::size_t width = 8;

  void add(const glm::vec3& min, const glm::vec3& max);
  void clear();
  std::size_t size() const { return size_; }
  // Copies box i of another.
  void add(const box_lanes& from, std::size_t i);

  // visible[i] is 0 where box i is outside of the frustum for sure; else 1.
  void find_visible(const frustum& f, std::vector<std::uint8_t>& visible) const;

 private:
  struct lane {
    float middle[3][width], half[3][width];
  };
  std::vector<lane> lanes_;
  std::size_t size_ = 0;
};

// All polygons of a world, group by group, in clusters of at most so many: each group is split along the longest side
// of its polygons' middles, at half of them rounded to whole clusters, until one is left. Inside a cluster they are in
// the order of the source, which is the one that meshes are made for.
struct cluster_set {
  cluster_set(const baked_world& world, std::uint32_t most);

  std::vector<std::uint32_t> stored;       // polygons
  std::vector<std::uint32_t> begin;        // of each cluster, and the end of the last
  std::vector<std::uint32_t> group_begin;  // first cluster of each group, and the end of the last
  box_lanes boxes;

  std::uint32_t count() const { return static_cast<std::uint32_t>(begin.size()) - 1; }
};

}  // namespace sightcell::bench
