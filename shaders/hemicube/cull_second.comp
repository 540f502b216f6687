#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/cull_scene.glsl"
#include "hemicube/cull.glsl"

// Second pass: draws every other cluster that the depths of the first pass do not occlude.
layout(binding = hemicube_texture_levels) uniform sampler2D levels;

// Factor by which the depth of a box is taken as nearer: the possible error of the rasterizer's interpolation.
const float depth_slack = 1.001;
// A box that covers more blocks of the coarsest level than this on a side is drawn without a test.
const int most_blocks = 16;

// Returns whether every pixel that the box may cover is nearer than the box. A comparison with NaN fails, and the box
// is then drawn.
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
  // One more pixel on each side, then clamped to the face. A box beside the face keeps the pixels of its border.
  vec2 scale = face.pixels.zw / (face.kept.yw - face.kept.xz);
  ivec2 first_of_face = ivec2(face.pixels.xy), last_of_face = first_of_face + ivec2(face.pixels.zw) - 1;
  ivec2 first = first_of_face + ivec2(floor(clamp((low - face.kept.xz) * scale - 1.0, vec2(0.0), face.pixels.zw)));
  ivec2 last = first_of_face + ivec2(floor(clamp((high - face.kept.xz) * scale + 1.0, vec2(0.0), face.pixels.zw)));
  first = min(first, last_of_face);
  last = min(last, last_of_face);

  int level = 1;
  while (level < int(hemicube_depth_levels) && any(greaterThan((last >> level) - (first >> level), ivec2(3)))) ++level;
  first >>= level;
  last >>= level;
  if (any(greaterThanEqual(last - first, ivec2(most_blocks)))) return false;
  float depth = depth_slack * view.eye.w / nearest;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      if (!(texelFetch(levels, ivec2(x, y), level).x > depth)) return false;
    }
  }
  return true;
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
