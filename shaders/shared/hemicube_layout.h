// Structs, bindings and sizes of the hemicube passes. Read by GLSL and by C++ (bake/src/hemicube/gpu).
#ifdef __cplusplus
#pragma once
#include "shared/glsl_types.h"
namespace sightcell::shaders {
#endif

const uint hemicube_background = 0xFFFFFFFFu;  // value of the id image where there is no polygon

// Work group sizes: of gather.comp in pixels, of collect.comp in list entries.
const uint hemicube_group_width = 16u;
const uint hemicube_group_height = 16u;
const uint hemicube_collect_size = 256u;

// Clusters per work group of the culling shaders.
const uint hemicube_cull_size = 256u;
// The first pass draws the clusters that were visible in one of this number of hemicubes before this one. The samples
// of a cell are on six faces in turns, so the last hemicube alone is not enough.
const uint hemicube_memory = 8u;
// Triangles per cluster, at most, and invocations per work group of the shaders that have a group per cluster. These
// groups are in rows of hemicube_most_columns, because OpenGL guarantees no more than 65535 along one axis.
const uint hemicube_cluster_size = 128u;
const uint hemicube_most_columns = 32768u;
const uint hemicube_number_size = 256u;  // invocations of number_clusters.comp
const uint hemicube_sum_size = 64u;      // clusters whose triangles are added up in one word
// Levels of the hierarchical depth below the full size. A work group of depth_levels.comp makes all levels of one block
// of 2^levels x 2^levels pixels.
const uint hemicube_depth_levels = 5u;
const uint hemicube_depth_block = 32u;

const uint hemicube_faces = 5u;
const uint hemicube_classes = 8u;  // hemicube/gpu/gpu_geometry.h: polygon_class
// Words of an indirect draw: count, instances, first index, base vertex, base instance.
const uint hemicube_command_words = 5u;

// Vertex attributes.
const uint hemicube_attribute_position = 0u;
const uint hemicube_attribute_source_id = 1u;
const uint hemicube_attribute_uv = 2u;     // of MASK polygons
const uint hemicube_attribute_mask = 3u;   // index of the mask
const uint hemicube_attribute_alpha = 4u;  // alpha of the vertex color

// Uniform blocks.
const uint hemicube_block_face = 0u;
const uint hemicube_block_gather = 1u;
const uint hemicube_block_cull = 2u;
const uint hemicube_block_cull_scene = 3u;

// Textures.
const uint hemicube_texture_ids = 0u;
const uint hemicube_texture_depth = 1u;
const uint hemicube_texture_levels = 2u;  // hierarchical depth; level 0 is the depth after the first pass

// Images.
const uint hemicube_image_level = 0u;  // and the hemicube_depth_levels units after it
const uint hemicube_image_ids = 0u;    // in resolve.comp
const uint hemicube_image_second_ids = 1u;

// Storage buffers.
const uint hemicube_buffer_counts = 0u;  // hemicube_count per source id; all 0 between hemicubes
// Number of polygons, number of work groups of collect.comp that are done, then the source ids whose count is not 0, in
// any order. Both numbers are 0 between hemicubes.
const uint hemicube_buffer_found = 1u;
const uint hemicube_found_header = 2u;    // words
const uint hemicube_buffer_result = 2u;   // the result, see below, as far as hemicube_buffer_arrived does not reach
const uint hemicube_buffer_arrived = 6u;  // the beginning of the result, in memory that the host reads

const uint hemicube_buffer_masks = 3u;   // hemicube_mask per mask
const uint hemicube_buffer_texels = 4u;  // alphas, four per word, lowest byte first

// For culling. Passes share bindings, because OpenGL guarantees only eight.
const uint hemicube_buffer_group_draws = 0u;  // per face and work group: number of clusters that are drawn
const uint hemicube_buffer_clusters = 5u;     // hemicube_cluster, grouped by class
const uint hemicube_buffer_commands = 6u;     // one draw per face and cluster; index count 0 if the cluster is culled
const uint hemicube_buffer_last_seen = 7u;    // per cluster: number of the last hemicube in which it was visible, or 0
const uint hemicube_buffer_packed = 5u;       // compact.comp: the remaining draws in the same order
const uint hemicube_buffer_lists = 7u;        // how many remain per face and class, see hemicube/lists.glsl
const uint hemicube_buffer_cluster_of = 5u;   // resolve.comp: cluster of each source id

// For the triangles of drawn clusters, beside hemicube_buffer_packed and hemicube_buffer_lists.
const uint hemicube_buffer_vertices = 0u;       // xyz; w is the source id, see gpu_geometry.cpp
const uint hemicube_buffer_indices = 1u;        // of all triangles
const uint hemicube_buffer_triangle_sums = 2u;  // kept triangles per hemicube_sum_size clusters
const uint hemicube_buffer_kept = 6u;           // hemicube_kept per cluster of the lists
const uint hemicube_buffer_kept_indices = 0u;   // pack_triangles.comp: of the kept triangles

// For gather.comp, after the draws.
const uint hemicube_buffer_sums = 5u;  // one vec4 per work group of gather.comp: its sum of importance

// The result, in 32-bit words: number of polygons, three unused words, four sums of importance as floats, then (id,
// pixels, first pixel) per polygon in any order.
const uint hemicube_result_sums = 4u;
const uint hemicube_result_header = 8u;

// One face of a hemicube. Clip coordinates are dot products with (position - eye). Depth is reversed and has no far
// plane.
struct hemicube_face {
  vec4 eye;     // xyz; w: distance of the near plane in meters
  vec4 clip_x;  // xyz
  vec4 clip_y;  // xyz
  vec4 clip_w;  // xyz; the direction the face looks along
};

struct hemicube_gather {
  uint resolution;      // S, width and height of the front face in pixels
  uint group_count;     // number of work groups of gather.comp
  float near_over_far;  // near plane / far plane: the depth value that counts as 1
  uint unused_word;
};

// Consecutive polygons in device order, and the box around them.
struct hemicube_cluster {
  vec4 center;  // xyz
  vec4 extent;  // xyz; half size
  uint first_polygon;
  uint polygon_count;
  uint unused_a, unused_b;
};

// The draws of a face and class, which are consecutive.
struct hemicube_list {
  uint clusters;        // number of clusters
  uint first_cluster;   // number of clusters in the lists before
  uint whole_clusters;  // clusters if these are drawn with all triangles, else 0
  // The draw of the kept triangles.
  uint index_count, instances, first_index, base_vertex, base_instance;
};

// Which triangles of a drawn cluster are kept: one bit each.
struct hemicube_kept {
  uvec4 bits;
  uint triangles;
  uint unused_a, unused_b, unused_c;
};

struct hemicube_cull_face {
  vec4 forward, right, up;  // xyz
  vec4 kept;                // smallest and largest x, smallest and largest y on the image plane at distance 1
  vec4 pixels;              // x, y, width, height of the face in the atlas
};

struct hemicube_cull {
  vec4 eye;     // xyz; w: distance of the near plane in meters
  uint number;  // number of the hemicube, from 1 upward
  uint unused_a, unused_b, unused_c;
  hemicube_cull_face faces[hemicube_faces];
};

// Data that all hemicubes of a source share.
struct hemicube_cull_scene {
  uint cluster_count;
  uint hiding_clusters;             // clusters of opaque and MASK polygons, which are first
  uint group_count;                 // work groups of culling, of hemicube_cull_size clusters of one class each
  float pixel_slack;                // more than the error of the device's coordinates of corners, in pixels
  uvec4 classes[hemicube_classes];  // first cluster, number of clusters, first work group, number of work groups
};

// The pixels of one polygon. Pixels of the atlas are numbered row by row from its lower left corner.
struct hemicube_count {
  uint pixels;
  uint pixels_after;  // 9 S^2 minus the number of the first pixel: a maximum, so that 0 means none
};

// The alpha image of a MASK material: see bake/scene/include/sightcell/scene/alpha_mask.h.
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
static_assert(sizeof(hemicube_list) == 32);
static_assert(sizeof(hemicube_kept) == 32);
static_assert(sizeof(hemicube_cull_face) == 80);
static_assert(sizeof(hemicube_cull) == 432);
static_assert(sizeof(hemicube_cull_scene) == 144);
static_assert(sizeof(hemicube_mask) == 32);
static_assert(sizeof(hemicube_count) == 8);
static_assert(sizeof(hemicube_face) == 64);
static_assert(sizeof(hemicube_gather) == 16);
}  // namespace sightcell::shaders
#endif
