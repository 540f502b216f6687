// What both culling shaders share: the test against the frustum, and where an indirect command goes.
#ifndef CULL_GLSL
#define CULL_GLSL

#include "scene.glsl"

struct draw_command {  // VkDrawIndexedIndirectCommand
  uint index_count, instance_count, first_index;
  int vertex_offset;
  uint first_instance;
};

struct bin_record {
  uint first_slot;  // of the bin, in `commands`
  uint compact_slots;  // 1: visible commands follow each other, counts[bin] of them; 0: each has a slot of its own
};

layout(std430, set = 1, binding = 2) writeonly buffer command_block { draw_command commands[]; };
layout(std430, set = 1, binding = 3) buffer count_block { uint counts[]; };  // commands by bin; then draws, triangles
layout(std430, set = 1, binding = 4) readonly buffer bin_block { bin_record bins[]; };

layout(push_constant) uniform constants {
  vec4 eye;
  vec4 planes[5];  // normals to the inside; the planes contain the eye
  uint count;      // of clusters or of commands
  uint bin_count;
};

bool in_frustum(vec4 sphere) {
  vec3 from_eye = sphere.xyz - eye.xyz;
  for (int i = 0; i < 5; ++i) {
    if (dot(planes[i].xyz, from_eye) < -sphere.w) return false;
  }
  return true;
}

// slot: of the command if the slots of the bin are not compacted.
void put(draw_command c, uint bin, uint slot, bool is_visible) {
  c.instance_count = is_visible ? 1u : 0u;
  if (bins[bin].compact_slots == 0u) {
    commands[bins[bin].first_slot + slot] = c;
    atomicMax(counts[bin], slot + 1u);
  } else if (is_visible) {
    commands[bins[bin].first_slot + atomicAdd(counts[bin], 1u)] = c;
  }
  if (!is_visible) return;
  atomicAdd(counts[bin_count], 1u);
  atomicAdd(counts[bin_count + 1u], c.index_count / 3u);
}

#endif
