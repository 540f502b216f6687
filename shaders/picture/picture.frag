#version 450 core
#include "shared/picture_layout.h"

layout(std140, binding = picture_block_view) uniform view_block { picture_view view; };
layout(std140, binding = picture_block_material) uniform material_block { picture_material material; };
layout(binding = picture_texture_base_color) uniform sampler2D base_color;

in vec3 from_eye;
in vec2 texture_uv;
in vec4 vertex_color;
layout(location = 0) out vec4 color;

const vec3 sun_direction = vec3(0.432, 0.792, 0.432);  // toward the sun; a unit vector

void main() {
  // The normal of the polygon, from derivatives and facing the viewer. The file needs no normals.
  vec3 normal = cross(dFdx(from_eye), dFdy(from_eye));
  vec4 base = texture(base_color, texture_uv) * material.base_color * vertex_color;
  if (base.a < material.alpha_cutoff) discard;

  float distance_squared = dot(from_eye, from_eye);
  vec3 toward_eye = -from_eye * inversesqrt(max(distance_squared, 1e-12));
  float length_squared = dot(normal, normal);
  // A polygon that is viewed edge-on may have no derivative. It is lit as if it faced the viewer.
  normal = length_squared > 0.0 ? normal * inversesqrt(length_squared) : toward_eye;
  if (dot(normal, toward_eye) < 0.0) normal = -normal;

  float sun = 0.70 * max(dot(normal, sun_direction), 0.0);
  float lamp = 0.12 * dot(normal, toward_eye);
  vec3 sky_light = mix(vec3(0.16, 0.15, 0.14), vec3(0.30, 0.34, 0.40), 0.5 + 0.5 * normal.y);
  vec3 lit = base.rgb * (vec3(1.0, 0.96, 0.88) * sun + vec3(lamp) + sky_light);

  float haze = 1.0 - exp(-view.sky.w * sqrt(distance_squared));
  color = vec4(mix(lit, view.sky.rgb, haze), max(base.a, material.alpha_opaque));
}
