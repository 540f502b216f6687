#version 450 core
#include "shared/hemicube_layout.h"

layout(location = hemicube_attribute_position) in vec3 position;
// Source id of the polygon that ends in this vertex; only a polygon's last vertex counts.
layout(location = hemicube_attribute_source_id) in uint source_id;

layout(std140, binding = hemicube_block_face) uniform face_block { hemicube_face face; };

flat out uint polygon_id;
// The see-through pass tests against the depths of the opaque one: same bits in both programs.
invariant gl_Position;

void main() {
  // Subtracting the eye first keeps precision far from the origin.
  vec3 p = position - face.eye.xyz;
  gl_Position = vec4(dot(p, face.clip_x.xyz), dot(p, face.clip_y.xyz), face.eye.w, dot(p, face.clip_w.xyz));
  polygon_id = source_id;
}
