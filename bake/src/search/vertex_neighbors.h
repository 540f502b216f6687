#pragma once
// Which polygons share a vertex, after welding vertices that lie at exactly the same place.
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

class vertex_neighbors {
 public:
  explicit vertex_neighbors(const scene::world_geometry& geometry);

  // Calls visit(neighbor) for every polygon that shares a vertex with this one, in a fixed order; one that shares two
  // vertices is visited twice, the polygon itself three times. Absent polygons have no neighbors.
  template <typename Visit>
  void for_each(std::uint32_t polygon, Visit visit) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = corners_[3 * std::size_t{polygon} + k];
      if (corner == scene::no_index) continue;
      for (std::uint32_t i = starts_[corner]; i < starts_[corner + 1]; ++i) visit(polygons_[i]);
    }
  }

 private:
  std::vector<std::uint32_t> corners_;   // per polygon three welded vertices; no_index for absent ones
  std::vector<std::uint32_t> starts_;    // per welded vertex: first entry in polygons_
  std::vector<std::uint32_t> polygons_;  // ascending per vertex
};

}  // namespace sightcell::bake
