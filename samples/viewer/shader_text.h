#pragma once
// The viewer's shaders. Depth is reversed and has no far plane: clip coordinates are dot products with (place - eye).

namespace viewer {

inline constexpr const char* scene_vert = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 tint;
layout(location = 0) uniform vec4 eye;  // w: distance of the near plane
layout(location = 1) uniform vec3 clip_x;
layout(location = 2) uniform vec3 clip_y;
layout(location = 3) uniform vec3 clip_w;
out vec3 from_eye;
out vec2 texture_uv;
out vec4 vertex_color;

void main() {
  from_eye = position - eye.xyz;
  texture_uv = uv;
  vertex_color = tint;
  gl_Position = vec4(dot(from_eye, clip_x), dot(from_eye, clip_y), eye.w, dot(from_eye, clip_w));
}
)";

// Lit by the polygon's own normal, from derivatives, so that scenes without normals and textures show their shape; the
// same light as in sightcell::picture. mark.a = 1 replaces the color: what a cell set leaves out must be seen from
// afar, so it gets no haze and little shade.
inline constexpr const char* scene_frag = R"(#version 450 core
layout(location = 4) uniform vec4 sky;  // a: haze per meter
layout(location = 5) uniform vec4 base_color;
layout(location = 6) uniform vec2 alpha;  // x: cutoff, y: 1 writes alpha as 1
layout(location = 7) uniform vec4 mark;
layout(location = 8) uniform float brightness;
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

  float sun = 0.70 * max(dot(normal, toward_sun), 0.0);
  float lamp = 0.12 * abs(facing);
  vec3 ambient = mix(vec3(0.16, 0.15, 0.14), vec3(0.30, 0.34, 0.40), 0.5 + 0.5 * normal.y);
  vec3 lit = brightness * base.rgb * (vec3(1.0, 0.96, 0.88) * sun + vec3(lamp) + ambient);
  float haze = 1.0 - exp(-sky.a * sqrt(distance_squared));
  vec3 usual = mix(lit, sky.rgb, haze);
  vec3 marked = mark.rgb * (0.5 + 0.5 * max(dot(normal, toward_sun), 0.0));
  color = vec4(mix(usual, marked, mark.a), max(base.a, alpha.y));
}
)";

// Lines as strips of constant width on the screen: core OpenGL promises no line wider than a pixel. One line per
// instance, two triangles; both ends are clipped to the near plane before they are widened.
inline constexpr const char* line_vert = R"(#version 450 core
layout(location = 0) in vec3 line_a;
layout(location = 1) in vec3 line_b;
layout(location = 2) in vec4 own_color;
layout(location = 0) uniform vec4 eye;
layout(location = 1) uniform vec3 clip_x;
layout(location = 2) uniform vec3 clip_y;
layout(location = 3) uniform vec3 clip_w;
layout(location = 4) uniform vec4 screen;  // xy: size in pixels; z: line width in pixels; w: alpha
out vec4 line_color;

vec4 to_clip(vec3 place) {
  vec3 p = place - eye.xyz;
  return vec4(dot(p, clip_x), dot(p, clip_y), eye.w, dot(p, clip_w));
}

void main() {
  vec4 a = to_clip(line_a), b = to_clip(line_b);
  line_color = vec4(own_color.rgb, own_color.a * screen.w);
  const float nearest = 0.01;  // meters
  if (a.w < nearest && b.w < nearest) {
    gl_Position = vec4(0.0, 0.0, 0.0, -1.0);  // behind the eye
    return;
  }
  if (a.w < nearest) a = mix(a, b, (nearest - a.w) / (b.w - a.w));
  if (b.w < nearest) b = mix(b, a, (nearest - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * screen.xy;
  float longness = length(along);
  vec2 aside = longness > 1e-4 ? vec2(-along.y, along.x) / longness : vec2(1.0, 0.0);
  int vertex = gl_VertexID;
  bool at_end = vertex == 1 || vertex == 2 || vertex == 4;
  float side = vertex == 0 || vertex == 1 || vertex == 3 ? -1.0 : 1.0;
  vec4 p = at_end ? b : a;
  p.xy += side * aside * screen.z / screen.xy * p.w;
  gl_Position = p;
}
)";

inline constexpr const char* line_frag = R"(#version 450 core
in vec4 line_color;
layout(location = 0) out vec4 color;

void main() {
  color = line_color;
}
)";

}  // namespace viewer
