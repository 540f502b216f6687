#version 450 core
#include "shared/reliability_layout.h"
#include "reliability/lowest.glsl"

// Raises the map around new samples, one invocation per texel, and finds the lowest texel of its square. The formulas
// are those of bake/src/sampler/importance_depth.cpp.
layout(local_size_x = reliability_group_side, local_size_y = reliability_group_side) in;

layout(std140, binding = reliability_block) uniform change_block { reliability_change change; };
layout(std430, binding = reliability_buffer_samples) readonly buffer samples_buffer { reliability_sample samples[]; };
layout(std430, binding = reliability_buffer_excluded) readonly buffer excluded_buffer { uvec4 excluded[]; };
layout(std430, binding = reliability_buffer_values) buffer values_buffer { float values[]; };
layout(std430, binding = reliability_buffer_lowest) writeonly buffer lowest_buffer { reliability_texel lowest[]; };

float reliability_of(reliability_sample s, vec2 place) {
  vec2 away = (place - s.place.xy) * change.aspect.xy;
  float horizontal = away.x < 0.0 ? s.variance.z : s.variance.x;
  float vertical = away.y > 0.0 ? s.variance.y : s.variance.w;
  float square = dot(away, away);
  float a = square > 0.0 ? away.x * away.x / square : 0.5;
  return a * exp(-square / horizontal) + (1.0 - a) * exp(-square / vertical);
}

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  uint number = at.y * reliability_map_size + at.x;
  vec2 place = (vec2(at) + 0.5) / float(reliability_map_size);
  float value = change.first_sample == 0u ? 0.0 : values[number];
  for (uint i = change.first_sample; i < change.sample_count; ++i) value = max(value, reliability_of(samples[i], place));
  for (uint i = 0u; i < change.excluded_count; ++i) {
    if (all(greaterThanEqual(at, excluded[i].xy)) && all(lessThanEqual(at, excluded[i].zw))) value = 1.0;
  }
  values[number] = value;
  keep_lowest(reliability_texel(value, number));
  if (gl_LocalInvocationIndex == 0u) lowest[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = candidates[0];
}
