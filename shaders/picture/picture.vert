#version 450 core
#include "shared/picture_layout.h"

layout(location = picture_attribute_position) in vec3 position;
layout(location = picture_attribute_uv) in vec2 uv;
layout(location = picture_attribute_color) in vec4 tint;

layout(std140, binding = picture_block_view) uniform view_block { picture_view view; };

out vec3 from_eye;
out vec2 texture_uv;
out vec4 vertex_color;

void main() {
  from_eye = position - view.eye.xyz;
  texture_uv = uv;
  vertex_color = tint;
  gl_Position = vec4(dot(from_eye, view.clip_x.xyz), dot(from_eye, view.clip_y.xyz), view.eye.w,
                     dot(from_eye, view.clip_w.xyz));
}
