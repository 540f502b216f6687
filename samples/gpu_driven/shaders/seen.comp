#version 450 core
// Marks the clusters that are in the picture of everything.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 2) uniform usampler2D ids;  // cluster + 1; 0: none
layout(std430, binding = 1) writeonly buffer seen_block { uint seen[]; };

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, textureSize(ids, 0)))) return;
  uint id = texelFetch(ids, at, 0).x;
  if (id != 0u) seen[id - 1u] = 1u;
}
