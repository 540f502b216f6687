#version 450
// Base color, and a simple light: sun, sky and a little haze. Normals are those of the triangles.
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(constant_id = 0) const uint alpha_mode = 0;  // 0: opaque, 1: mask, 2: blend

layout(set = 0, binding = 2) uniform sampler2DArray textures;

layout(push_constant) uniform constants {
  vec4 eye;
  vec4 clip_x, clip_y, clip_w;  // clip_x.w: 1 / distance of the haze; clip_y.w: unused
};

layout(location = 0) in vec3 from_eye;
layout(location = 1) in vec2 texture_uv;
layout(location = 2) in vec4 color;
layout(location = 3) flat in uint material;
layout(location = 0) out vec4 result;

const vec3 sun = vec3(0.48, 0.76, 0.44);
const vec3 sky = vec3(0.46, 0.63, 0.86);

float wrapped(float at, uint wrap, int texels) {
  if (wrap == 1u) return clamp(at, 0.5 / float(texels), 1.0 - 0.5 / float(texels));
  if (wrap == 2u) return 1.0 - abs(mod(at, 2.0) - 1.0);
  return at;
}

void main() {
  material_record own = materials[material];
  ivec2 texels = textureSize(textures, 0).xy;
  vec3 at = vec3(wrapped(texture_uv.x, own.wrap_u, texels.x), wrapped(texture_uv.y, own.wrap_v, texels.y),
                 float(own.base_texture));
  vec4 base = own.base_color * color * texture(textures, at);
  if (alpha_mode == 1u) {
    // The bake tests the full image. Smaller versions of it would open or close the mask at a distance.
    float alpha = own.base_color.a * color.a * textureLod(textures, at, 0.0).a;
    if (alpha < own.alpha_cutoff) discard;
  }
  vec3 across = cross(dFdx(from_eye), dFdy(from_eye));
  float area = length(across);
  vec3 normal = area > 0.0 ? across / area : vec3(0.0, 1.0, 0.0);
  vec3 view = normalize(from_eye);
  if (dot(normal, view) > 0.0) normal = -normal;
  vec3 light = mix(vec3(0.44, 0.39, 0.34), vec3(0.58, 0.65, 0.76), 0.5 + 0.5 * normal.y) +
               vec3(0.58, 0.51, 0.40) * max(dot(normal, sun), 0.0) + vec3(0.12) * -dot(normal, view);
  float haze = 1.0 - exp(-length(from_eye) * clip_x.w);
  vec3 lit = mix(base.rgb * light, sky, haze);
  result = vec4(lit, alpha_mode == 2u ? base.a : 0.0);  // the target's alpha: the sum of all that was blended
}
