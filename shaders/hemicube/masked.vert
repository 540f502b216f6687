#version 450 core
#include "shared/hemicube_layout.h"

layout(location = hemicube_attribute_position) in vec3 position;
layout(location = hemicube_attribute_source_id) in uint source_id;
layout(location = hemicube_attribute_uv) in vec2 uv;
layout(location = hemicube_attribute_mask) in uint mask;
layout(location = hemicube_attribute_alpha) in float alpha;

layout(std140, binding = hemicube_block_face) uniform face_block { hemicube_face face; };

flat out uint polygon_id;
flat out uint polygon_mask;
out vec2 place;
out float place_alpha;
// The non-occluder pass tests against these depths, so both programs must compute the same bits.
invariant gl_Position;

void main() {
  // As in polygon.vert.
  vec3 p = position - face.eye.xyz;
  gl_Position = vec4(dot(p, face.clip_x.xyz), dot(p, face.clip_y.xyz), face.eye.w, dot(p, face.clip_w.xyz));
  polygon_id = source_id;
  polygon_mask = mask;
  place = uv;
  place_alpha = alpha;
}
