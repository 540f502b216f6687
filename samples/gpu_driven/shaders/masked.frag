#version 450 core
#include "records.glsl"
#include "view.glsl"
#include "shade.glsl"

layout(location = 0) out vec4 result;
layout(location = 1) out uint cluster;

void main() {
  material_record own = materials[numbers.y];
  vec4 base = base_of(own);
  // The bake tests the full image. Smaller versions of it would open or close the mask at a distance.
  float alpha = own.base_color.a * color.a * textureLod(textures, place_in_texture(own), 0.0).a;
  if (alpha < own.alpha_cutoff) discard;
  result = vec4(lit(base.rgb), 0.0);
  cluster = numbers.x + 1u;
}
