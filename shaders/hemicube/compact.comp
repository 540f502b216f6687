#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/cull_scene.glsl"
#include "hemicube/lists.glsl"

// Packs the draws of a face and class: draws without indices are removed, the others keep their order, because of two
// polygons at the same depth the later one is kept. One work group per face and group of clusters; it adds up what the
// groups before it draw.
layout(local_size_x = hemicube_cull_size) in;

layout(std430, binding = hemicube_buffer_commands) readonly buffer commands_buffer { uint commands[]; };
layout(std430, binding = hemicube_buffer_group_draws) readonly buffer group_draws_buffer { uint group_draws[]; };
layout(std430, binding = hemicube_buffer_packed) writeonly buffer packed_buffer { uint packed_commands[]; };

shared uint sums[hemicube_cull_size];

// Returns the sum of the values of all invocations up to this one.
uint sum_up_to(uint local, uint value) {
  sums[local] = value;
  barrier();
  for (uint reach = 1u; reach < hemicube_cull_size; reach *= 2u) {
    uint sum = sums[local] + (local >= reach ? sums[local - reach] : 0u);
    barrier();
    sums[local] = sum;
    barrier();
  }
  return sums[local];
}

void main() {
  uint group = gl_WorkGroupID.x, face = gl_WorkGroupID.y, local = gl_LocalInvocationIndex;
  uint which = class_of_group(group), cluster = cluster_of_invocation(group, local);
  uvec4 clusters = scene.classes[which];

  uint part = 0u;
  for (uint i = clusters.z + local; i < group; i += hemicube_cull_size) part += group_draws[face * scene.group_count + i];
  sum_up_to(local, part);
  uint before = sums[hemicube_cull_size - 1u];
  barrier();

  uint from = hemicube_command_words * (face * scene.cluster_count + cluster);
  bool drawn = cluster != no_cluster && commands[from] != 0u;
  uint number = before + sum_up_to(local, drawn ? 1u : 0u);
  if (drawn) {
    uint to = hemicube_command_words * (face * scene.cluster_count + clusters.x + number - 1u);
    for (uint word = 0u; word < hemicube_command_words; ++word) packed_commands[to + word] = commands[from + word];
  }
  bool last = group + 1u == clusters.z + clusters.w;
  if (last && local == hemicube_cull_size - 1u)
    lists[face * hemicube_classes + which] = hemicube_list(number, 0u, 0u, 0u, 1u, 0u, 0u, 0u);
}
