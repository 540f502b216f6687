#pragma once
// Input and output of drawing a face, and the table of functions that each instruction set implements. The structs have
// plain pointers, because the files that are compiled for one instruction set must not call functions that other files
// share (kernel.inl).
#include <cstdint>

#include "hemicube/cpu/cluster_scene.h"

namespace sightcell::bake::cpu {

inline constexpr std::uint32_t tile_size = 8;  // pixels along a tile's side
inline constexpr std::uint32_t tile_pixels = tile_size * tile_size;

// One face of a hemicube. The point with eye-space coordinates (X, Y, Z) along right, up, forward is at pixel
// (X / Z * half + center_x, Y / Z * half + center_y) of the kept part, y up; pixel centers at .5.
struct face_frame {
  float eye[3], right[3], up[3], forward[3];
  float min_x, max_x, min_y, max_y;  // kept part of the image plane at distance 1, rounded up to whole tiles
  float half;                        // S / 2
  std::int32_t center_x, center_y;   // pixels
  std::uint32_t width, height;       // pixels kept
  std::uint32_t atlas_x, atlas_y, atlas_width;
};

enum class tile_state : std::uint8_t { empty, exact, stale };

// The pixels of one face in tiles of 8 x 8, row by row inside a tile from its lower left, tiles row by row. The memory
// of a tile is valid only where its state is not empty.
struct tile_image {
  std::uint32_t tiles_x = 0, tiles_y = 0;
  std::uint32_t stride = 0;         // tiles from one row to the next, a multiple of 8
  float* inverse_depths = nullptr;  // 1/Z, 0 in the background
  std::uint32_t* ids = nullptr;
  // The hierarchical depth: the smallest inverse depth of each tile. May be too small where the state is stale.
  float* farthest = nullptr;
  tile_state* states = nullptr;
};

struct polygon_pixels {
  std::uint32_t pixels = 0, first = 0;
};

// Pixels per polygon of one hemicube. All zeros between hemicubes.
struct polygon_counter {
  polygon_pixels* by_id = nullptr;
  std::uint64_t* found = nullptr;  // a bit per source id with pixels
};

// Sums of the importance of one face in image axes (gpu_gather.h has the formula), and scratch for two rows of pixels.
struct importance_sums {
  double right = 0.0, up = 0.0, left = 0.0, down = 0.0;
  float* row_below = nullptr;  // 2 x width, rounded up to whole tiles
};

// A cluster_tree without its containers.
struct tree_view {
  const tree_node* nodes = nullptr;  // null: no triangles
  const cluster* clusters = nullptr;
  const triangle_block* blocks = nullptr;
  const block_marks* marks = nullptr;
  const std::uint32_t* masked = nullptr;  // null: no triangle is masked
};

struct scene_view {
  tree_view opaque, masked, see_through;
  const masked_triangle* masked_triangles = nullptr;
  const alpha_test* tests = nullptr;
  const std::uint8_t* texels = nullptr;
  const block_counts* counts = nullptr;
};

struct kernel {
  const char* name;
  // Clears image, draws the opaque and masked triangles into it, and counts the pixels of the see-through ones.
  void (*draw)(const scene_view& scene, const face_frame& face, const tile_image& image,
               const polygon_counter& counter);
  void (*gather)(const face_frame& face, const tile_image& image, const polygon_counter& counter);
  // far_plane: in meters; larger depths are clamped to it.
  void (*add_importance)(const face_frame& face, const tile_image& image, float far_plane, importance_sums& sums);
};

// A build contains the kernels for which SIGHTCELL_HAS_..._KERNEL is defined.
extern const kernel avx2_kernel, sse4_kernel, neon_kernel, portable_kernel;

}  // namespace sightcell::bake::cpu
