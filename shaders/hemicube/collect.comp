#version 450 core
#include "shared/hemicube_layout.h"

// Moves the found polygons, their pixel counts and first pixels into the result, and resets all counts to 0 for the
// next hemicube. The first work group adds up the importance.
layout(local_size_x = hemicube_collect_size) in;

layout(std140, binding = hemicube_block_gather) uniform gather_block { hemicube_gather settings; };
layout(std430, binding = hemicube_buffer_counts) buffer counts_buffer { hemicube_count counts[]; };
layout(std430, binding = hemicube_buffer_found) readonly buffer found_buffer {
  uint found_count;
  uint found[];
};
layout(std430, binding = hemicube_buffer_result) buffer result_buffer { uint result[]; };
layout(std430, binding = hemicube_buffer_sums) readonly buffer sums_buffer { vec4 group_sums[]; };

shared vec4 sums[hemicube_collect_size];

void list_polygons() {
  uint stride = gl_NumWorkGroups.x * hemicube_collect_size;
  for (uint i = gl_GlobalInvocationID.x; i < found_count; i += stride) {
    uint id = found[i];
    hemicube_count seen = counts[id];
    counts[id] = hemicube_count(0u, 0u);
    uint at = hemicube_result_header + 3u * atomicAdd(result[0], 1u);
    result[at] = id;
    result[at + 1u] = seen.pixels;
    result[at + 2u] = 9u * settings.resolution * settings.resolution - seen.pixels_after;
  }
}

// In fixed order, so that the sums are always the same.
void add_importance() {
  uint local = gl_LocalInvocationIndex;
  vec4 sum = vec4(0.0);
  for (uint i = local; i < settings.group_count; i += hemicube_collect_size) sum += group_sums[i];
  sums[local] = sum;
  for (uint half_size = hemicube_collect_size / 2u; half_size > 0u; half_size /= 2u) {
    barrier();
    if (local < half_size) sums[local] += sums[local + half_size];
  }
  if (local != 0u) return;
  for (uint i = 0u; i < 4u; ++i) result[hemicube_result_sums + i] = floatBitsToUint(sums[0][i]);
}

void main() {
  list_polygons();
  if (gl_WorkGroupID.x == 0u) add_importance();
}
