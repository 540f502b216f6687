#pragma once
// The scene as the rasterizer traverses it: a tree of boxes with eight children per node. Its leaves are clusters of up
// to 128 triangles that are close together. The traversal is front to back.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "hemicube/cpu/alpha_tables.h"
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

struct cluster_scene {
  cluster_tree opaque;       // occluders without alpha test, or where it passes everywhere
  cluster_tree masked;       // occluders with alpha test
  cluster_tree see_through;  // non-occluders
  alpha_tables alpha;

  // Builds the trees in parallel on the caller's TBB arena. The result depends on world only, which is not needed
  // afterwards.
  explicit cluster_scene(const scene::world_geometry& world);
};

}  // namespace sightcell::bake::cpu
