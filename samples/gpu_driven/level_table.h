#pragma once
// Reads the levels of detail that `sightcell pack --meshlets --levels` adds to the table of meshlets of a .glb. A
// reader of docs/meshlets.md that needs nothing of Sightcell.
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gpu_driven {

inline constexpr std::uint32_t no_level_group = 0xFFFFFFFFu;

struct level_links {
  std::uint32_t made_by = no_level_group;    // the level group that it takes the place of; none: a leaf
  std::uint32_t member_of = no_level_group;  // the level group that others take the place of; none: nothing is coarser
};

// In the space of the mesh.
struct level_group {
  float x = 0.0f, y = 0.0f, z = 0.0f, radius = 0.0f;
  float error = 0.0f;
};

// Clusters are numbered in the primitive: its meshlets (the leaves), then coarse ones, each after those below it.
struct primitive_levels {
  std::uint32_t leaves = 0;
  std::vector<level_links> links;  // by cluster
  std::vector<level_group> groups;
  std::vector<std::uint32_t> coarse_triangles;  // of each coarse cluster
  std::vector<std::uint32_t> coarse_indices;    // of all coarse clusters: vertices of the primitive, three per triangle
};

// By mesh and primitive of glTF. Primitives without a level group are left out.
using level_table = std::map<std::pair<std::uint32_t, std::uint32_t>, primitive_levels>;

// file: a .glb. Throws gpu-driven.no-levels if it has no levels, gpu-driven.levels if its table contradicts itself.
level_table read_levels(const std::string& file);

}  // namespace gpu_driven
