#pragma once
// Finds the polygons that share a vertex, after vertices at exactly the same position are welded.
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// The table of a scene. The geometry is needed by the constructor only.
class vertex_neighbors {
 public:
  vertex_neighbors() = default;  // of no polygons
  // Threads: runs in the TBB arena of the calling thread. The result does not depend on the number of threads.
  explicit vertex_neighbors(const scene::world_geometry& geometry);

  // Calls visit(neighbor) for each polygon that shares a vertex with this one, in a fixed order: twice for one that
  // shares two vertices, three times for the polygon itself. Absent polygons have no neighbors.
  template <typename Visit>
  void for_each(std::uint32_t polygon, Visit visit) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t start = lists_of_[3 * std::size_t{polygon} + k];
      if (start == scene::no_index) continue;
      const std::uint32_t* list = lists_.data() + start;
      for (std::uint32_t i = 1; i <= list[0]; ++i) visit(list[i]);
    }
  }

 private:
  std::vector<std::uint32_t> lists_of_;  // per corner of each polygon: where its list starts; no_index: absent
  std::vector<std::uint32_t> lists_;     // per welded vertex: the number of its polygons, and these, ascending
};

}  // namespace sightcell::bake
