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

// Culling on the device: invocations of cull.comp and compact.comp.
const uint hemicube_cull_size = 64u;
// The first pass draws what one of so many hemicubes before this one saw: a cell's samples look in turns out of six
// faces.
const uint hemicube_memory = 8u;
const uint hemicube_compact_size = 256u;
// Levels of the hierarchical depth below the full size; a work group of depth_levels.comp makes all of one block of
// 2^levels pixels a side.
const uint hemicube_depth_levels = 5u;
const uint hemicube_depth_block = 32u;

const uint hemicube_faces = 5u;
const uint hemicube_classes = 8u;  // hemicube/gpu/gpu_geometry.h: polygon_class
const uint hemicube_command_words =
    5u;  // of an indirect draw: count, instances, first index, base vertex, base instance

// Vertex attributes.
const uint hemicube_attribute_position = 0u;
const uint hemicube_attribute_source_id = 1u;
const uint hemicube_attribute_uv = 2u;     // of masked polygons
const uint hemicube_attribute_mask = 3u;   // which mask
const uint hemicube_attribute_alpha = 4u;  // of the corner's color

// Uniform blocks.
const uint hemicube_block_face = 0u;
const uint hemicube_block_gather = 1u;
const uint hemicube_block_cull = 2u;
const uint hemicube_block_cull_scene = 3u;

// Textures.
const uint hemicube_texture_ids = 0u;
const uint hemicube_texture_depth = 1u;
const uint hemicube_texture_levels = 2u;      // hierarchical depth; level 0 is the depth after the first pass
const uint hemicube_texture_second_ids = 3u;  // of the second pass

// Images.
const uint hemicube_image_level = 0u;  // and the hemicube_depth_levels units after it
const uint hemicube_image_ids = 0u;    // in resolve.comp

// Storage buffers.
const uint hemicube_buffer_counts = 0u;  // hemicube_count per source id; all 0 between hemicubes
const uint hemicube_buffer_found = 1u;   // number, then the source ids whose count is not 0, in any order
const uint hemicube_buffer_result = 2u;  // what is read back, see below

const uint hemicube_buffer_masks = 3u;   // hemicube_mask per mask
const uint hemicube_buffer_texels = 4u;  // alphas, four per word, lowest byte first

// Of culling, in turns: OpenGL promises no more than eight bindings.
const uint hemicube_buffer_clusters = 5u;       // hemicube_cluster, grouped by class
const uint hemicube_buffer_commands = 6u;       // a draw per face and cluster; no index when the cluster is culled
const uint hemicube_buffer_last_seen = 7u;      // per cluster the number of the last hemicube that saw some of it, or 0
const uint hemicube_buffer_packed = 5u;         // compact.comp: the draws that are left, in the same order
const uint hemicube_buffer_packed_counts = 7u;  // how many, per face and class
const uint hemicube_buffer_cluster_of = 5u;     // resolve.comp: cluster per source id

// Of the gather, after the draws.
const uint hemicube_buffer_sums = 5u;  // a vec4 per work group of gather.comp: its sum of importance

// The result, in 32-bit words: number of polygons, three unused, four sums of importance as floats, then (id, pixels,
// first pixel) per polygon in any order.
const uint hemicube_result_sums = 4u;
const uint hemicube_result_header = 8u;

// One face. Clip coordinates are dot products with (position - eye); depth is reversed and has no far plane.
struct hemicube_face {
  vec4 eye;     // xyz; w: distance of the near plane in metres
  vec4 clip_x;  // xyz
  vec4 clip_y;  // xyz
  vec4 clip_w;  // xyz; the direction the face looks along
};

struct hemicube_gather {
  uint resolution;      // S
  uint group_count;     // work groups of gather.comp
  float near_over_far;  // near plane / far plane: depth that counts as 1
  uint unused_word;
};

// A run of polygons in device order and the box around them.
struct hemicube_cluster {
  vec4 center;  // xyz
  vec4 extent;  // xyz; half size
  uint first_polygon;
  uint polygon_count;
  uint unused_a, unused_b;
};

struct hemicube_cull_face {
  vec4 forward, right, up;  // xyz
  vec4 kept;                // smallest and largest x, smallest and largest y on the image plane at distance 1
  vec4 pixels;              // x, y, width, height of its rectangle in the atlas
};

struct hemicube_cull {
  vec4 eye;     // xyz; w: distance of the near plane in metres
  uint number;  // of the hemicube, from 1 upward
  uint unused_a, unused_b, unused_c;
  hemicube_cull_face faces[hemicube_faces];
};

// What all hemicubes of a source share.
struct hemicube_cull_scene {
  uint cluster_count;
  uint hiding_clusters;  // those of opaque and masked polygons: they come first
  uint unused_a, unused_b;
  uvec4 classes[hemicube_classes];  // first cluster, number of clusters
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
static_assert(hemicube_result_header == hemicube_result_sums + 4u);
static_assert(1u << hemicube_depth_levels == hemicube_depth_block);
static_assert(sizeof(hemicube_cluster) == 48);
static_assert(sizeof(hemicube_cull_face) == 80);
static_assert(sizeof(hemicube_cull) == 432);
static_assert(sizeof(hemicube_cull_scene) == 144);
static_assert(sizeof(hemicube_mask) == 32);
static_assert(sizeof(hemicube_count) == 8);
static_assert(sizeof(hemicube_face) == 64);
static_assert(sizeof(hemicube_gather) == 16);
}  // namespace sightcell::shaders
#endif
