#version 450 core
#include "shared/reliability_layout.h"
#include "reliability/lowest.glsl"

// The lowest texel of the map.
layout(local_size_x = reliability_groups) in;

layout(std430, binding = reliability_buffer_lowest) readonly buffer lowest_buffer { reliability_texel lowest[]; };
layout(std430, binding = reliability_buffer_result) writeonly buffer result_buffer { reliability_texel result; };

void main() {
  keep_lowest(lowest[gl_LocalInvocationIndex]);
  if (gl_LocalInvocationIndex == 0u) result = candidates[0];
}
