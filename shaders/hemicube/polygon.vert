#version 450 core
#include "shared/hemicube_layout.h"

layout(location = hemicube_attribute_position) in vec3 position;
// Source id of the polygon whose last vertex this is. Only the last vertex of a polygon is used.
layout(location = hemicube_attribute_source_id) in uint source_id;

layout(std140, binding = hemicube_block_face) uniform face_block { hemicube_face face; };

flat out uint polygon_id;
// The non-occluder pass tests against the depths of the opaque pass, so both programs must compute the same bits.
invariant gl_Position;

void main() {
  // Subtracting the eye first preserves precision far from the origin.
  vec3 p = position - face.eye.xyz;
  gl_Position = vec4(dot(p, face.clip_x.xyz), dot(p, face.clip_y.xyz), face.eye.w, dot(p, face.clip_w.xyz));
  polygon_id = source_id;
}
