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

// What a masked polygon is tested with: texture coordinates and alphas of its corners.
struct masked_triangle {
  float u[3], v[3], alpha[3];
  std::uint32_t mask = 0;
};

// An alpha_mask whose texels lie among those of all.
struct mask_texels {
  std::uint32_t first = 0, width = 0, height = 0;
  float cutoff = 0.0f;
  scene::wrap wrap_u = scene::wrap::repeat, wrap_v = scene::wrap::repeat;
};

struct cluster_scene {
  cluster_tree opaque;                            // hides all over
  cluster_tree masked;                            // hides where its alpha passes
  cluster_tree see_through;                       // seen, never hides
  std::vector<masked_triangle> masked_triangles;  // one per world_geometry::masked
  std::vector<mask_texels> masks;                 // one per world_geometry::masks
  std::vector<std::uint8_t> texels;               // of all masks, and a few more for who reads four at a time

  // Deterministic; built in parallel on the caller's arena. world may go away.
  explicit cluster_scene(const scene::world_geometry& world);
};

}  // namespace sightcell::bake::cpu
