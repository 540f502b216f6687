#pragma once
// Simplifies the triangles of a group of clusters, for cluster_dag.h.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct simplified_group {
  std::vector<std::vector<std::uint32_t>> clusters;  // three vertices of the mesh per triangle
  double error = 0.0;                                // distance to what was simplified, of its texture too
};

// Returns about half as many triangles, in clusters. Nothing where little can be saved, or where the border would
// change. indices: three vertices of the mesh per triangle. positions: by vertex, the number of its position: equal for
// vertices in the same place. locked: by position: 1 for those that other groups have too.
std::optional<simplified_group> simplify_group(const geometry& mesh, std::span<const std::uint32_t> indices,
                                               std::span<const std::uint32_t> positions,
                                               std::span<const std::uint8_t> locked);

}  // namespace sightcell::scene
