#version 450 core
#include "records.glsl"
#include "view.glsl"
#include "shade.glsl"

layout(location = 0) out vec4 result;
layout(location = 1) out uint cluster;  // + 1; pictures without such an image drop it

void main() {
  result = vec4(lit(base_of(materials[numbers.y]).rgb), 0.0);
  cluster = numbers.x + 1u;
}
