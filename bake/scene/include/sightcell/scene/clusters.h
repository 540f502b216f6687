#pragma once
// Clusters (meshlets) of the triangles of a primitive, as a .pvs file with clusters stores them.
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Triangles of a cluster, at most, unless the host has given its own clusters.
inline constexpr std::uint32_t most_cluster_triangles = 128;

struct mesh_clusters {
  std::vector<std::uint32_t> of_triangle;  // by triangle: the number of its cluster
  std::uint32_t count = 0;                 // each number below it occurs
};

// Returns the clusters of a primitive: those of geometry::clusters if the host has given any. Else triangles that
// follow each other in the index buffer, where such clusters are about as compact as those of meshoptimizer, so that
// the host keeps its index order; else those of meshoptimizer. The same geometry gives the same clusters. mesh: with
// any positions; those that are not finite leave the index order. Cost: O(triangles * log triangles).
mesh_clusters clusters_of(const geometry& mesh);

}  // namespace sightcell::scene
