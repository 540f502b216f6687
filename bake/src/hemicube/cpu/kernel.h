#pragma once
// What drawing a face needs and leaves behind, and the functions that do it, once per instruction set. Plain pointers:
// the files that are compiled for one instruction set call no library function that others could share with them.
#include <cstdint>

#include "hemicube/cpu/cluster_scene.h"

namespace sightcell::bake::cpu {

inline constexpr std::uint32_t tile_size = 8;  // pixels along a tile's side
inline constexpr std::uint32_t tile_pixels = tile_size * tile_size;

// One face of a hemicube. The point with eye-space coordinates (X, Y, Z) along right, up, forward lies at pixel
// (X / Z * half + center_x, Y / Z * half + center_y) of the kept part, y up; pixel centers at .5.
struct face_frame {
  float eye[3], right[3], up[3], forward[3];
  float min_x, max_x, min_y, max_y;  // kept part of the image plane at distance 1, tiles filled up
  float half;                        // S / 2
  std::int32_t center_x, center_y;   // pixels
  std::uint32_t width, height;       // pixels kept
  std::uint32_t atlas_x, atlas_y, atlas_width;
};

enum class tile_state : std::uint8_t { empty, exact, stale };

// The pixels of one face in tiles of 8 x 8, row by row inside a tile from its lower left, tiles row by row. Memory of a
// tile counts only where its state is not empty.
struct tile_image {
  std::uint32_t tiles_x = 0, tiles_y = 0;
  std::uint32_t stride = 0;         // tiles from one row to the next, a multiple of 8
  float* inverse_depths = nullptr;  // 1/Z, 0 where there is nothing
  std::uint32_t* ids = nullptr;
  // Of each tile, the smallest inverse depth: the hierarchical depth. May be too small where the state is stale.
  float* farthest = nullptr;
  tile_state* states = nullptr;
};

struct polygon_pixels {
  std::uint32_t pixels = 0, first = 0;
};

// Pixels per polygon of one hemicube: all zeros between hemicubes.
struct polygon_counter {
  polygon_pixels* by_id = nullptr;
  std::uint64_t* found = nullptr;  // a bit per source id that has pixels
};

// Sums of the importance of one face in image axes (gpu_gather.h has the formula), and scratch for two rows of pixels.
struct importance_sums {
  double right = 0.0, up = 0.0, left = 0.0, down = 0.0;
  float* row_below = nullptr;  // 2 x width, filled up to whole tiles
};

// A cluster_tree without its containers.
struct tree_view {
  const tree_node* nodes = nullptr;  // null: no triangles
  const cluster* clusters = nullptr;
  const triangle_block* blocks = nullptr;
  const block_marks* marks = nullptr;
  const std::uint32_t* masked = nullptr;  // null: none is
};

struct scene_view {
  tree_view opaque, masked, see_through;
  const masked_triangle* masked_triangles = nullptr;
  const mask_texels* masks = nullptr;
  const std::uint8_t* texels = nullptr;
};

struct kernel {
  const char* name;
  // Draws opaque and masked triangles into image, which is emptied first, then counts the see-through ones.
  void (*draw)(const scene_view& scene, const face_frame& face, const tile_image& image,
               const polygon_counter& counter);
  void (*gather)(const face_frame& face, const tile_image& image, const polygon_counter& counter);
  // far_plane: metres; what is further counts as there.
  void (*add_importance)(const face_frame& face, const tile_image& image, float far_plane, importance_sums& sums);
};

// A build has those that SIGHTCELL_HAS_..._KERNEL names.
extern const kernel avx2_kernel, sse4_kernel, neon_kernel, portable_kernel;

}  // namespace sightcell::bake::cpu
