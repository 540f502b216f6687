#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/lists.glsl"

// Numbers the clusters of all lists from 0 upward, and clears what the triangles of the clusters are added up in. One
// work group.
layout(local_size_x = hemicube_number_size) in;

layout(std430, binding = hemicube_buffer_triangle_sums) writeonly buffer sums_buffer { uint triangle_sums[]; };

const uint list_count = hemicube_faces * hemicube_classes;
shared uint clusters_of[list_count];

void main() {
  uint local = gl_LocalInvocationIndex;
  if (local < list_count) clusters_of[local] = lists[local].clusters;
  barrier();
  uint total = 0u;
  for (uint i = 0u; i < list_count; ++i) {
    if (i == local) lists[local].first_cluster = total;
    total += clusters_of[i];
  }
  if (local == 0u) {
    uint columns = min(total, hemicube_most_columns);
    all_clusters = uvec4(columns, (total + hemicube_most_columns - 1u) / hemicube_most_columns, 1u, total);
  }
  uint sums = (total + hemicube_sum_size - 1u) / hemicube_sum_size;
  for (uint i = local; i < sums; i += hemicube_number_size) triangle_sums[i] = 0u;
}
