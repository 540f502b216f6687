#pragma once
// The scene as the rasteriser walks it: triangles in clusters of at most 128 that lie together, clusters as the leaves
// of a tree of boxes with eight children per node (the super-clusters), walked front to back.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake::cpu {

inline constexpr std::uint32_t cluster_size = 128;  // triangles
inline constexpr std::uint32_t max_tree_depth = 64;

// Eight triangles; lane k of every array belongs to one. No indices: gathering three shared vertices costs more than
// moving them three times.
struct alignas(32) triangle_block {
  float x[3][8], y[3][8], z[3][8];  // of the corners, world space
  std::uint32_t ids[8];             // source ids
};

// What is rarely needed of a block.
struct block_marks {
  std::uint8_t valid = 0;       // a bit per lane that holds a triangle
  std::uint8_t both_sides = 0;  // a bit per lane that is seen from behind too
};

struct cluster {
  std::uint32_t first_block = 0, block_count = 0;
};

struct alignas(32) tree_node {
  float low[3][8], high[3][8];  // boxes of the children; lanes beyond count are zeros
  std::int32_t child[8];        // a node, or ~number of a cluster
  std::uint32_t count = 0;
};

// Triangles that are drawn in one go. An empty tree has no nodes; node 0 is the root.
struct cluster_tree {
  std::vector<tree_node> nodes;
  std::vector<cluster> clusters;
  std::vector<triangle_block> blocks;
  std::vector<block_marks> marks;     // per block
  std::vector<std::uint32_t> masked;  // 8 per block: into world_geometry::masked, or no_index; empty: none is
};

struct cluster_scene {
  cluster_tree opaque;                              // hides all over
  cluster_tree masked;                              // hides where its alpha passes
  cluster_tree see_through;                         // seen, never hides
  const scene::world_geometry* geometry = nullptr;  // for masks

  // Deterministic; built in parallel on the caller's arena.
  explicit cluster_scene(const scene::world_geometry& world);
};

// Rule 1 of seeing: is a masked polygon (number in world_geometry::masked) there at the place with weights u and v of
// its second and third corner?
bool alpha_passes(const cluster_scene& scene, std::uint32_t masked, float u, float v);

}  // namespace sightcell::bake::cpu
