#version 450 core
#include "shared/hemicube_layout.h"

// Packs the draws of a face and class: draws without indices are removed, the others keep their order, because of two
// polygons at the same depth the later one is kept. One work group per face and class.
layout(local_size_x = hemicube_compact_size) in;

layout(std140, binding = hemicube_block_cull_scene) uniform cull_scene_block { hemicube_cull_scene scene; };
layout(std430, binding = hemicube_buffer_commands) readonly buffer commands_buffer { uint commands[]; };
layout(std430, binding = hemicube_buffer_packed) writeonly buffer packed_buffer { uint packed_commands[]; };
layout(std430, binding = hemicube_buffer_packed_counts) writeonly buffer counts_buffer { uint packed_counts[]; };

shared uint before[hemicube_compact_size];

void main() {
  uint face = gl_WorkGroupID.y, local = gl_LocalInvocationIndex;
  uvec4 clusters = scene.classes[gl_WorkGroupID.x];
  uint list = face * scene.cluster_count + clusters.x, kept = 0u;
  for (uint start = 0u; start < clusters.y; start += hemicube_compact_size) {
    uint at = hemicube_command_words * (list + start + local);
    bool drawn = start + local < clusters.y && commands[at] != 0u;
    before[local] = drawn ? 1u : 0u;
    barrier();
    // Inclusive prefix sum: the number of remaining draws up to this one.
    for (uint reach = 1u; reach < hemicube_compact_size; reach *= 2u) {
      uint sum = before[local] + (local >= reach ? before[local - reach] : 0u);
      barrier();
      before[local] = sum;
      barrier();
    }
    if (drawn) {
      uint to = hemicube_command_words * (list + kept + before[local] - 1u);
      for (uint word = 0u; word < hemicube_command_words; ++word) packed_commands[to + word] = commands[at + word];
    }
    kept += before[hemicube_compact_size - 1u];
    barrier();
  }
  if (local == 0u) packed_counts[face * hemicube_classes + gl_WorkGroupID.x] = kept;
}
