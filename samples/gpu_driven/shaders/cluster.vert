#version 450 core
// The transform of a cluster is in attributes that advance per instance: base_instance of its command is its number.
#include "view.glsl"

layout(std140, binding = 0) uniform view_block { camera_record view; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 tint;
layout(location = 3) in vec4 row_x;
layout(location = 4) in vec4 row_y;
layout(location = 5) in vec4 row_z;
layout(location = 6) in uvec2 cluster_and_material;

layout(location = 0) out vec3 from_eye;
layout(location = 1) out vec2 texture_uv;
layout(location = 2) out vec4 color;
layout(location = 3) flat out uvec2 numbers;

invariant gl_Position;  // all pictures have the same depths

void main() {
  vec4 local = vec4(position, 1.0);
  from_eye = vec3(dot(row_x, local), dot(row_y, local), dot(row_z, local)) - view.eye.xyz;
  texture_uv = uv;
  color = tint;
  numbers = cluster_and_material;
  gl_Position = vec4(dot(from_eye, view.clip_x.xyz), dot(from_eye, view.clip_y.xyz), view.eye.w,
                     dot(from_eye, view.clip_w.xyz));
}
