#pragma once
// Levels of detail of a primitive in clusters (meshlets): a DAG whose leaves are the clusters of its triangles. Groups
// of neighboring clusters are simplified while their borders keep still, and become fewer clusters, which form groups
// again. So the host chooses the level of each part of a mesh apart from all others, and no gaps appear between levels.
// docs/meshlets.md describes the rule.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct dag_sphere {
  glm::vec3 center{0.0f};  // space of the mesh
  float radius = 0.0f;

  bool operator==(const dag_sphere&) const = default;
};

struct dag_cluster {
  std::uint32_t first_triangle = 0, triangle_count = 0;  // in cluster_dag::indices
  std::uint32_t made_by = no_index;  // the group that it replaces with others; no_index: it is a leaf
  std::uint32_t group = no_index;    // the group that it is a member of; no_index: nothing replaces it

  bool operator==(const dag_cluster&) const = default;
};

// Clusters that are replaced together.
struct dag_group {
  std::uint32_t first_cluster = 0, cluster_count = 0;  // what replaces it
  // How far what replaces it is from the leaves below it, and they from it: the sum of the distances between levels,
  // measured at corners, centers of edges and centers of triangles, with the way along the surface to the same texture
  // coordinates; 0 where they are in one place up to rounding. Not less than that of any group below it.
  float error = 0.0f;
  dag_sphere bounds;        // contains the leaves below it, and the spheres of all groups below it
  std::uint32_t level = 1;  // 1: its members were there before the first simplification

  bool operator==(const dag_group&) const = default;
};

struct cluster_dag {
  std::vector<dag_cluster> clusters;   // the leaves first, with the numbers of clusters_of(); each after those below it
  std::vector<dag_group> groups;       // each after those below it
  std::vector<std::uint32_t> indices;  // three per triangle: vertices of the mesh
  std::vector<std::uint32_t> of_triangle;  // by triangle of the mesh: its leaf
  std::uint32_t leaf_count = 0;            // of clusters

  bool operator==(const cluster_dag&) const = default;
};

// Returns whether coarser triangles can take the place of those of a draw: its material is opaque, it occludes, it does
// not move, and it is no level of detail of another kind.
bool may_have_levels(const scene& s, const draw& d);

// Returns the DAG of a primitive. Simplification moves no vertex: coarser levels use fewer of those of the mesh. It
// keeps the borders of a primitive and, as meshoptimizer does, the seams of its attributes. The same geometry gives the
// same DAG. mesh: with any positions; where one is not finite, there are leaves only. levels: false for leaves only.
// Cost: O(triangles * log triangles), about 40 us per triangle; memory for about 100 bytes per triangle.
cluster_dag build_cluster_dag(const geometry& mesh, bool levels = true);

}  // namespace sightcell::scene
