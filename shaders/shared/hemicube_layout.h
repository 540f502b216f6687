// Structs, bindings and sizes of the hemicube passes; read by GLSL and by C++ (bake/src/source).
#ifdef __cplusplus
#pragma once
#include "shared/glsl_types.h"
namespace sightcell::shaders {
#endif

const uint hemicube_background = 0xFFFFFFFFu;  // in the id image: no polygon

// Work group of gather.comp in pixels, and of collect.comp in list entries.
const uint hemicube_group_width = 16u;
const uint hemicube_group_height = 16u;
const uint hemicube_collect_size = 256u;

// Vertex attributes.
const uint hemicube_attribute_position = 0u;
const uint hemicube_attribute_source_id = 1u;
const uint hemicube_attribute_uv = 2u;    // of masked polygons
const uint hemicube_attribute_mask = 3u;  // which mask
const uint hemicube_attribute_alpha = 4u;  // of the corner's color

// Uniform blocks.
const uint hemicube_block_face = 0u;
const uint hemicube_block_gather = 1u;

// Textures.
const uint hemicube_texture_ids = 0u;
const uint hemicube_texture_depth = 1u;

// Storage buffers.
const uint hemicube_buffer_counts = 0u;  // hemicube_count per source id; all 0 between hemicubes
const uint hemicube_buffer_found = 1u;   // number, then the source ids whose count is not 0, in any order
const uint hemicube_buffer_result = 2u;  // what is read back, see below

const uint hemicube_buffer_masks = 3u;   // hemicube_mask per mask
const uint hemicube_buffer_texels = 4u;  // alphas, four per word, lowest byte first

// The result, in 32-bit words: number of polygons, three unused, four floats per work group, (id, pixels, first pixel) per polygon.
const uint hemicube_result_header = 4u;

// One face. Clip coordinates are dot products with (position - eye); depth is reversed and has no far plane.
struct hemicube_face {
  vec4 eye;     // xyz; w: distance of the near plane in metres
  vec4 clip_x;  // xyz
  vec4 clip_y;  // xyz
  vec4 clip_w;  // xyz; the direction the face looks along
};

struct hemicube_gather {
  uint resolution;      // S
  uint group_count;     // work groups of gather.comp: the polygon list in the result starts after their sums
  float near_over_far;  // near plane / far plane: depth that counts as 1
  uint unused_word;
};

// Pixels of the atlas count from its lower left corner, row by row.
struct hemicube_count {
  uint pixels;
  uint pixels_after;  // 9 S^2 less the first pixel: a maximum, so that 0 means none
};

// Where a MASK material is there: see bake/scene/include/sightcell/scene/alpha_mask.h.
struct hemicube_mask {
  uint first_texel;
  uint width;
  uint height;
  float cutoff;
  uint wrap_u;  // as in scene::wrap: 0 repeats, 1 clamps, 2 mirrors
  uint wrap_v;
  uint unused_a, unused_b;
};

#ifdef __cplusplus
static_assert(sizeof(hemicube_mask) == 32);
static_assert(sizeof(hemicube_count) == 8);
static_assert(sizeof(hemicube_face) == 64);
static_assert(sizeof(hemicube_gather) == 16);
}  // namespace sightcell::shaders
#endif
