#pragma once
// The sample's shaders. Depth is reversed and has no far plane: clip coordinates are dot products with (place - eye).

namespace engine_hook {

// Per-draw data comes as instance attributes: the base instance of a draw call, or of an indirect command, is its unit.
inline constexpr const char* vertex_text = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 row_x;
layout(location = 3) in vec4 row_y;
layout(location = 4) in vec4 row_z;
layout(location = 5) in uvec2 mirrored_unit;
layout(location = 0) uniform vec4 eye;  // w: distance of the near plane
layout(location = 1) uniform vec3 clip_x;
layout(location = 2) uniform vec3 clip_y;
layout(location = 3) uniform vec3 clip_w;
out vec2 texture_uv;
flat out uint mirrored;
flat out uint unit;

void main() {
  vec4 local = vec4(position, 1.0);
  vec3 from_eye = vec3(dot(row_x, local), dot(row_y, local), dot(row_z, local)) - eye.xyz;
  texture_uv = uv;
  mirrored = mirrored_unit.x;
  unit = mirrored_unit.y;
  gl_Position = vec4(dot(from_eye, clip_x), dot(from_eye, clip_y), eye.w, dot(from_eye, clip_w));
}
)";

// Back faces are told here and not by GL_CULL_FACE, so that mirrored instances need no draw calls of their own.
inline constexpr const char* fragment_text = R"(#version 450 core
layout(location = 4) uniform vec2 alpha;       // x: of the material, y: cutoff
layout(location = 5) uniform uint double_sided;
layout(location = 6) uniform uint show_backs;  // 1: of solid polygons, as surface 0xFFFFFFFF
layout(binding = 0) uniform sampler2D base_texture;
in vec2 texture_uv;
flat in uint mirrored;
flat in uint unit;
layout(location = 0) out uint surface;
layout(location = 1) out float layer;

void main() {
  bool back = double_sided == 0u && gl_FrontFacing == (mirrored == 1u);
  if (back && (show_backs == 0u || alpha.y > 0.0)) discard;
  if (alpha.y > 0.0 && texture(base_texture, texture_uv).a * alpha.x < alpha.y) discard;
  surface = back ? 0xFFFFFFFFu : unit + 1u;
  layer = 1.0;
}
)";

}  // namespace engine_hook
