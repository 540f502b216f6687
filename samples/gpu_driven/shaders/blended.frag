#version 450 core
// Alpha of the picture is the sum of the alphas of all blended polygons of a pixel.
#include "records.glsl"
#include "view.glsl"
#include "shade.glsl"

layout(early_fragment_tests) in;
layout(std430, binding = 1) buffer seen_block { uint seen[]; };  // by cluster
layout(location = 0) uniform uint marks;

layout(location = 0) out vec4 result;

void main() {
  vec4 base = base_of(materials[numbers.y]);
  result = vec4(lit(base.rgb), base.a);
  if (marks != 0u) seen[numbers.x] = 1u;
}
