#pragma once
// Input of the alpha tests of a scene, as the kernels read it: texture coordinates of the masked triangles, texels of
// the masks, and for each test what is known of blocks of texels, so that most tiles need no texels.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake::cpu {

inline constexpr std::uint32_t quads_per_block = 4;  // along its side

// A masked polygon: texture coordinates and alphas of its corners.
struct masked_triangle {
  float u[3], v[3], alpha[3];
  std::uint32_t test = 0;  // in alpha_tables::tests
};

// Number of blocks below and left of the corner of a block in which a lookup may pass and in which one may fail
// (summed-area tables, Crow 1984).
struct block_counts {
  std::uint32_t may_pass = 0, may_fail = 0;
};

// A mask with the alpha that its texels are multiplied with. A quad is the four texels of a bilinear lookup. Column 0
// and row 0 of the quads read the border of the mask, so there are width + 1 and height + 1.
struct alpha_test {
  std::size_t first = 0;  // in alpha_tables::texels
  std::uint32_t width = 0, height = 0;
  float cutoff = 0.0f;
  // The smallest number of which `number / 255 * alpha >= cutoff` holds; infinite if none does.
  float threshold = 0.0f;
  bool varies = false;  // alpha differs between the corners: there are no threshold and no block counts
  scene::wrap wrap_u = scene::wrap::repeat, wrap_v = scene::wrap::repeat;
  std::uint32_t first_count = 0, blocks_across = 0;  // in alpha_tables::counts; rows of blocks_across + 1; 0: no counts
};

struct alpha_tables {
  std::vector<masked_triangle> triangles;  // one per world_geometry::masked
  std::vector<alpha_test> tests;
  // Of all masks, with a border of one texel: height + 1 rows of width + 2 columns of two bytes, a texel and the one
  // above it. So the four bytes from an even offset on are a quad.
  std::vector<std::uint8_t> texels;
  std::vector<block_counts> counts;  // of tests whose alpha does not vary

  // The result depends on world only, which is not needed afterwards.
  // Memory: two bytes per texel of each mask, and half a byte per texel for each alpha that a mask is multiplied with,
  // up
  //   to 2^28 texels; tests beyond these have no counts.
  explicit alpha_tables(const scene::world_geometry& world);
};

}  // namespace sightcell::bake::cpu
