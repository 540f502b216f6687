#version 450 core
#include "shared/hemicube_layout.h"

// Moves the found polygons, their pixel counts and first pixels into the result, and resets all counts and the list for
// the next hemicube. The first work group adds up the importance.
layout(local_size_x = hemicube_collect_size) in;

layout(std140, binding = hemicube_block_gather) uniform gather_block { hemicube_gather settings; };
layout(std430, binding = hemicube_buffer_counts) buffer counts_buffer { hemicube_count counts[]; };
layout(std430, binding = hemicube_buffer_found) coherent buffer found_buffer {
  uint found_count;
  uint groups_done;
  uint found[];
};
layout(std430, binding = hemicube_buffer_result) writeonly buffer result_buffer { uint result[]; };
layout(std430, binding = hemicube_buffer_arrived) writeonly buffer arrived_buffer { uint arrived[]; };
layout(std430, binding = hemicube_buffer_sums) readonly buffer sums_buffer { vec4 group_sums[]; };

shared vec4 sums[hemicube_collect_size];

void write(uint at, uint value) {
  if (at < uint(arrived.length()))
    arrived[at] = value;
  else
    result[at] = value;
}

void list_polygons() {
  uint stride = gl_NumWorkGroups.x * hemicube_collect_size, count = found_count;
  if (gl_GlobalInvocationID.x == 0u) write(0u, count);
  for (uint i = gl_GlobalInvocationID.x; i < count; i += stride) {
    uint id = found[i], at = hemicube_result_header + 3u * i;
    hemicube_count seen = counts[id];
    counts[id] = hemicube_count(0u, 0u);
    write(at, id);
    write(at + 1u, seen.pixels);
    write(at + 2u, 9u * settings.resolution * settings.resolution - seen.pixels_after);
  }
}

// The last work group to finish its part of the list empties it: all have read its length.
void empty_list() {
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationIndex != 0u || atomicAdd(groups_done, 1u) + 1u != gl_NumWorkGroups.x) return;
  found_count = 0u;
  groups_done = 0u;
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
  for (uint i = 0u; i < 4u; ++i) write(hemicube_result_sums + i, floatBitsToUint(sums[0][i]));
}

void main() {
  list_polygons();
  empty_list();
  if (gl_WorkGroupID.x == 0u) add_importance();
}
