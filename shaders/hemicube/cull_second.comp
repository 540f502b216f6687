#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/cull_scene.glsl"
#include "hemicube/cull.glsl"
#include "hemicube/occluded.glsl"

// Second pass: draws every other cluster that the depths of the first pass do not occlude.
// Returns whether every pixel that the box may cover is nearer than the box.
bool hidden(hemicube_cluster c, hemicube_cull_face face) {
  vec3 from_eye = c.center.xyz - view.eye.xyz, reach = reach_of(c);
  float nearest = dot(face.forward.xyz, from_eye) - dot(abs(face.forward.xyz), reach);
  if (!(nearest > view.eye.w)) return false;
  vec2 low = vec2(3.4e38), high = vec2(-3.4e38);
  for (uint corner = 0u; corner < 8u; ++corner) {
    vec3 p = from_eye + reach * vec3((corner & 1u) != 0u ? 1.0 : -1.0, (corner & 2u) != 0u ? 1.0 : -1.0,
                                     (corner & 4u) != 0u ? 1.0 : -1.0);
    vec2 at = vec2(dot(face.right.xyz, p), dot(face.up.xyz, p)) / dot(face.forward.xyz, p);
    low = min(low, at);
    high = max(high, at);
  }
  vec2 scale = face.pixels.zw / (face.kept.yw - face.kept.xz);
  return occluded((low - face.kept.xz) * scale, (high - face.kept.xz) * scale, face, nearest, view.eye.w, 4);
}

void main() {
  uint cluster = cluster_of_invocation(gl_WorkGroupID.x, gl_LocalInvocationIndex), face = gl_WorkGroupID.y;
  bool drawn = false;
  if (cluster != no_cluster && !in_first_pass(cluster)) {
    hemicube_cluster c = clusters[cluster];
    drawn = in_frustum(c, view.faces[face]) && !hidden(c, view.faces[face]);
  }
  write_draw(cluster, face, drawn);
}
