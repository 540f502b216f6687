#pragma once
// The scene as the rasterizer traverses it: a tree of boxes with eight children per node. Its leaves are clusters of up
// to 128 triangles that are close together. The traversal is front to back.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake::cpu {

inline constexpr std::uint32_t cluster_size = 128;  // triangles
inline constexpr std::uint32_t max_tree_depth = 64;

// Eight triangles. Element k of each array belongs to triangle k. There are no indices, because gathering shared
// vertices costs more than transforming each of them several times.
struct alignas(32) triangle_block {
  float x[3][8], y[3][8], z[3][8];  // of the corners, world space
  std::uint32_t ids[8];             // source ids
};

// Properties of a block that are rarely needed.
struct block_marks {
  std::uint8_t valid = 0;       // a bit per lane that holds a triangle
  std::uint8_t both_sides = 0;  // a bit per lane with a double-sided triangle
};

struct cluster {
  std::uint32_t first_block = 0, block_count = 0;
};

struct alignas(32) tree_node {
  float low[3][8], high[3][8];  // boxes of the children; lanes beyond count are zeros
  std::int32_t child[8];        // number of a node, or ~number of a cluster
  std::uint32_t count = 0;
};

// Triangles that are drawn in one pass. Node 0 is the root. An empty tree has no nodes.
struct cluster_tree {
  std::vector<tree_node> nodes;
  std::vector<cluster> clusters;
  std::vector<triangle_block> blocks;
  std::vector<block_marks> marks;     // per block
  std::vector<std::uint32_t> masked;  // 8 per block: indices into world_geometry::masked, or no_index; may be empty
};

// Input of the alpha test of a masked polygon: texture coordinates and alphas of its corners.
struct masked_triangle {
  float u[3], v[3], alpha[3];
  std::uint32_t mask = 0;
  std::uint32_t first_count = 0, side = 0;  // its opacity map in cluster_scene::open_counts; side 0: none
};

// An alpha_mask. Its texels are a part of cluster_scene::texels, with a border of one texel.
struct mask_texels {
  std::uint32_t first = 0, width = 0, height = 0;
  float cutoff = 0.0f;
  scene::wrap wrap_u = scene::wrap::repeat, wrap_v = scene::wrap::repeat;
};

struct cluster_scene {
  cluster_tree opaque;                            // occluders without alpha test, or where it passes everywhere
  cluster_tree masked;                            // occluders with alpha test
  cluster_tree see_through;                       // non-occluders
  std::vector<masked_triangle> masked_triangles;  // one per world_geometry::masked
  std::vector<mask_texels> masks;                 // one per world_geometry::masks
  std::vector<std::uint8_t> texels;               // of all masks, with padding for reads of four bytes
  // Of all opacity maps: the number of parts that do not fail in the squares below and left of each corner of a square,
  // side + 1 numbers for each of side + 1 rows (summed-area table, Crow 1984).
  std::vector<std::uint32_t> open_counts;

  // Builds the trees in parallel on the caller's TBB arena. The result depends on world only, which is not needed
  // afterwards.
  explicit cluster_scene(const scene::world_geometry& world);
};

}  // namespace sightcell::bake::cpu
