#version 450
// Depth is reversed and has no far plane: clip coordinates are dot products with (position - eye).
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 tint;

layout(push_constant) uniform constants {
  vec4 eye;  // w: distance of the near plane
  vec4 clip_x, clip_y, clip_w;
};

layout(location = 0) out vec3 from_eye;
layout(location = 1) out vec2 texture_uv;
layout(location = 2) out vec4 color;
layout(location = 3) flat out uint material;

void main() {
  draw_record own = draws[gl_InstanceIndex];  // first_instance of the command
  vec4 local = vec4(position, 1.0);
  from_eye = vec3(dot(own.row_x, local), dot(own.row_y, local), dot(own.row_z, local)) - eye.xyz;
  texture_uv = uv;
  color = tint;
  material = own.material;
  gl_Position = vec4(dot(from_eye, clip_x.xyz), dot(from_eye, clip_y.xyz), eye.w, dot(from_eye, clip_w.xyz));
}
