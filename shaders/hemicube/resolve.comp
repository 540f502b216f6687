#version 450 core
#include "shared/hemicube_layout.h"

// Merges the two passes, one invocation per pixel. The nearer polygon is kept; of two at the same depth, the one in the
// later cluster, as if all clusters had been drawn in one pass. Records the cluster for the first passes of later
// hemicubes. Clears the ids of the second pass for the next hemicube, which costs less than clearing all pixels. The ids
// of the first pass are valid where the pass has a depth.
layout(local_size_x = hemicube_group_width, local_size_y = hemicube_group_height) in;

layout(std140, binding = hemicube_block_cull) uniform cull_block { hemicube_cull view; };
layout(binding = hemicube_texture_depth) uniform sampler2D depths;
layout(binding = hemicube_texture_levels) uniform sampler2D levels;
layout(binding = hemicube_image_ids, r32ui) uniform uimage2D ids;
layout(binding = hemicube_image_second_ids, r32ui) uniform uimage2D second_ids;
layout(std430, binding = hemicube_buffer_cluster_of) readonly buffer cluster_of_buffer { uint cluster_of[]; };
layout(std430, binding = hemicube_buffer_last_seen) buffer seen_buffer { uint last_seen[]; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(ids)))) return;
  float first_depth = texelFetch(levels, pixel, 0).x;
  uint second = imageLoad(second_ids, pixel).x;
  if (first_depth <= 0.0 && second == hemicube_background) return;
  uint id = first_depth > 0.0 ? imageLoad(ids, pixel).x : hemicube_background;
  uint cluster = id == hemicube_background ? 0u : cluster_of[id];
  if (second != hemicube_background) {
    imageStore(second_ids, pixel, uvec4(hemicube_background));
    uint cluster_of_second = cluster_of[second];
    if (id == hemicube_background || texelFetch(depths, pixel, 0).x > first_depth ||
        cluster_of_second > cluster) {
      imageStore(ids, pixel, uvec4(second));
      cluster = cluster_of_second;
    }
  }
  // All invocations that write here write the same value.
  if (last_seen[cluster] != view.number) last_seen[cluster] = view.number;
}
