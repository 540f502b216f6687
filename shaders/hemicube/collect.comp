#version 450 core
#include "shared/hemicube_layout.h"

// Moves the found polygons, their pixel counts and first pixels into the result and leaves all counts 0 for the next hemicube.
layout(local_size_x = hemicube_collect_size) in;

layout(std140, binding = hemicube_block_gather) uniform gather_block { hemicube_gather settings; };
layout(std430, binding = hemicube_buffer_counts) buffer counts_buffer { hemicube_count counts[]; };
layout(std430, binding = hemicube_buffer_found) readonly buffer found_buffer {
  uint found_count;
  uint found[];
};
layout(std430, binding = hemicube_buffer_result) writeonly buffer result_buffer { uint result[]; };

void main() {
  uint list = hemicube_result_header + 4u * settings.group_count;
  uint stride = gl_NumWorkGroups.x * hemicube_collect_size;
  for (uint i = gl_GlobalInvocationID.x; i < found_count; i += stride) {
    uint id = found[i];
    result[list + 3u * i] = id;
    result[list + 3u * i + 1u] = counts[id].pixels;
    result[list + 3u * i + 2u] = 9u * settings.resolution * settings.resolution - counts[id].pixels_after;
    counts[id] = hemicube_count(0u, 0u);
  }
  if (gl_GlobalInvocationID.x == 0u) result[0] = found_count;
}
