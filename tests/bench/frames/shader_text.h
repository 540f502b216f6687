#pragma once
// Flat surfaces: their number, and how many blended ones are in front. Depth is reversed and has no far plane: clip
// coordinates are dot products with (place - eye).

namespace sightcell::bench {

inline constexpr const char* frame_vertex_text = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 uv_alpha;
layout(location = 0) uniform vec4 eye;  // w: distance of the near plane
layout(location = 1) uniform vec3 clip_x;
layout(location = 2) uniform vec3 clip_y;
layout(location = 3) uniform vec3 clip_w;
out vec3 surface_uv;

void main() {
  vec3 from_eye = position - eye.xyz;
  surface_uv = uv_alpha;
  gl_Position = vec4(dot(from_eye, clip_x), dot(from_eye, clip_y), eye.w, dot(from_eye, clip_w));
}
)";

inline constexpr const char* frame_solid_text = R"(#version 450 core
layout(location = 4) uniform uint group;
layout(location = 0) out uint surface;
layout(location = 1) out float layer;

void main() {
  surface = group + 1u;
  layer = 1.0;
}
)";

// The finest level, as the bake has it.
inline constexpr const char* frame_masked_text = R"(#version 450 core
layout(location = 4) uniform uint group;
layout(location = 5) uniform vec2 alpha;  // x: of the material, y: cutoff
layout(binding = 0) uniform sampler2D base_texture;
in vec3 surface_uv;
layout(location = 0) out uint surface;
layout(location = 1) out float layer;

void main() {
  if (textureLod(base_texture, surface_uv.xy, 0.0).a * surface_uv.z * alpha.x < alpha.y) discard;
  surface = group + 1u;
  layer = 1.0;
}
)";

}  // namespace sightcell::bench
