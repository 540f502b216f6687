#pragma once
// Partitions clusters into groups of neighbors, for cluster_dag.h.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sightcell::scene {

// A cluster as the partition needs it.
struct grouped_cluster {
  std::span<const std::uint32_t> corners;  // three per triangle: numbers of positions
  glm::vec3 center{0.0f};
};

// Returns groups of up to `most` clusters: of those that share the most edges, and where none is left that shares one,
// of those that are close. By group: numbers of clusters. Each cluster is in one group. The same clusters give the same
// groups. Cost: O(corners * log corners).
std::vector<std::vector<std::uint32_t>> group_clusters(std::span<const grouped_cluster> clusters, std::size_t most);

}  // namespace sightcell::scene
