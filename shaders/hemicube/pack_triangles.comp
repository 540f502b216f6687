#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/lists.glsl"
#include "hemicube/cluster_group.glsl"

// Writes the indices of the kept triangles, in the order of the lists, of their clusters and in these, because of two
// polygons at the same depth the later one is kept. Completes the draw of each list.
layout(std430, binding = hemicube_buffer_indices) readonly buffer indices_buffer { uint indices[]; };
layout(std430, binding = hemicube_buffer_kept) readonly buffer kept_buffer { hemicube_kept kept[]; };
layout(std430, binding = hemicube_buffer_triangle_sums) readonly buffer sums_buffer { uint triangle_sums[]; };
layout(std430, binding = hemicube_buffer_kept_indices) writeonly buffer kept_indices_buffer { uint kept_indices[]; };

shared uint sums[hemicube_cluster_size];

// Returns the number of kept triangles in the clusters before this one.
uint triangles_before(uint number) {
  uint local = gl_LocalInvocationIndex, whole = number / hemicube_sum_size, sum = 0u;
  for (uint i = local; i < whole; i += hemicube_cluster_size) sum += triangle_sums[i];
  for (uint i = whole * hemicube_sum_size + local; i < number; i += hemicube_cluster_size) sum += kept[i].triangles;
  sums[local] = sum;
  for (uint half_size = hemicube_cluster_size / 2u; half_size > 0u; half_size /= 2u) {
    barrier();
    if (local < half_size) sums[local] += sums[local + half_size];
  }
  barrier();
  return sums[0];
}

void main() {
  uint number = cluster_number();
  if (number >= all_clusters.w) return;
  uint list = list_of(number), before = triangles_before(number), local = gl_LocalInvocationIndex;
  uvec4 bits = kept[number].bits;
  uint triangles = kept[number].triangles;
  bool room = 3u * (before + triangles) <= uint(kept_indices.length());
  if (local == 0u) {
    if (number == lists[list].first_cluster) lists[list].first_index = 3u * before;
    if (!room) lists[list].whole_clusters = lists[list].clusters;
    atomicAdd(lists[list].index_count, 3u * triangles);
  }
  uint word = local / 32u, bit = local % 32u;
  if (!room || (bits[word] >> bit & 1u) == 0u) return;
  uint rank = uint(bitCount(bits[word] & ((1u << bit) - 1u)));
  for (uint i = 0u; i < word; ++i) rank += uint(bitCount(bits[i]));
  uint from = packed_commands[command_of(number, list) + 2u] + 3u * local, to = 3u * (before + rank);
  for (uint k = 0u; k < 3u; ++k) kept_indices[to + k] = indices[from + k];
}
