#pragma once
// Depth is reversed and has no far plane: clip coordinates are dot products with (position - eye).

namespace stream_client {

inline constexpr const char* scene_vert = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 tint;
layout(location = 0) uniform vec4 eye;  // w: distance of the near plane
layout(location = 1) uniform vec3 clip_x;
layout(location = 2) uniform vec3 clip_y;
layout(location = 3) uniform vec3 clip_w;
layout(location = 4) uniform mat4x3 to_world;
layout(location = 5) uniform vec3 uv_row_u;
layout(location = 6) uniform vec3 uv_row_v;
out vec3 from_eye;
out vec2 texture_uv;
out vec4 vertex_color;

void main() {
  from_eye = to_world * vec4(position, 1.0) - eye.xyz;
  texture_uv = vec2(dot(uv_row_u, vec3(uv, 1.0)), dot(uv_row_v, vec3(uv, 1.0)));
  vertex_color = tint;
  gl_Position = vec4(dot(from_eye, clip_x), dot(from_eye, clip_y), eye.w, dot(from_eye, clip_w));
}
)";

// The same light as in sightcell::picture: by the normal of the polygon, from derivatives.
inline constexpr const char* scene_frag = R"(#version 450 core
layout(location = 7) uniform vec4 base_color;
layout(location = 8) uniform vec2 alpha;  // x: cutoff, y: 1 writes alpha as 1
layout(location = 9) uniform vec4 sky;    // a: haze per meter
layout(binding = 0) uniform sampler2D base_texture;
in vec3 from_eye;
in vec2 texture_uv;
in vec4 vertex_color;
layout(location = 0) out vec4 color;

const vec3 toward_sun = vec3(0.432, 0.792, 0.432);  // length 1

void main() {
  vec3 normal = cross(dFdx(from_eye), dFdy(from_eye));
  vec4 base = texture(base_texture, texture_uv) * base_color * vertex_color;
  if (base.a < alpha.x) discard;
  float distance_squared = dot(from_eye, from_eye);
  vec3 toward_eye = -from_eye * inversesqrt(max(distance_squared, 1e-12));
  float length_squared = dot(normal, normal);
  normal = length_squared > 0.0 ? normal * inversesqrt(length_squared) : toward_eye;
  float facing = dot(normal, toward_eye);
  if (facing < 0.0) normal = -normal;
  vec3 ambient = mix(vec3(0.16, 0.15, 0.14), vec3(0.30, 0.34, 0.40), 0.5 + 0.5 * normal.y);
  vec3 light = vec3(1.0, 0.96, 0.88) * 0.70 * max(dot(normal, toward_sun), 0.0) + vec3(0.12 * abs(facing)) + ambient;
  float haze = 1.0 - exp(-sky.a * sqrt(distance_squared));
  color = vec4(mix(base.rgb * light, sky.rgb, haze), max(base.a, alpha.y));
}
)";

}  // namespace stream_client
