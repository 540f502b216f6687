#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/mark.glsl"

// Counts the pixels of each polygon and adds up their importance, with one invocation per atlas pixel. The formulas are
// those of bake/src/hemicube/gpu/gather_read_back.cpp.
layout(local_size_x = hemicube_group_width, local_size_y = hemicube_group_height) in;

layout(binding = hemicube_texture_ids) uniform usampler2D ids;
layout(binding = hemicube_texture_depth) uniform sampler2D depths;
layout(std430, binding = hemicube_buffer_sums) writeonly buffer sums_buffer { vec4 group_sums[]; };

shared uint ids_of_group[hemicube_group_width * hemicube_group_height];
shared uint mixed;  // not 0: the work group has pixels of several polygons
shared vec4 sums[hemicube_group_width * hemicube_group_height];

// Returns (near / far) / d, where d is the depth divided by the far plane, at most 1.
float nearness(ivec2 pixel) { return max(texelFetch(depths, pixel, 0).x, settings.near_over_far); }

// Returns max(0, d(neighbor) - d) / d.
float gap(float here, ivec2 neighbor) {
  float there = nearness(neighbor);
  return max(0.0, (1.0 / there - 1.0 / here) * here);
}

// Returns first pixel and size of the face that contains a pixel. The atlas has the front face, left | right, and down
// below up.
ivec4 face_of(ivec2 pixel) {
  int s = int(settings.resolution), h = s / 2;
  if (pixel.x < s) return ivec4(0, 0, s, s);
  if (pixel.x < 2 * s) return ivec4(pixel.x < s + h ? s : s + h, 0, h, s);
  return ivec4(2 * s, pixel.y < h ? 0 : h, s, h);
}

vec4 importance(ivec2 pixel) {
  ivec4 face = face_of(pixel);
  ivec2 at = pixel - face.xy;
  float here = nearness(pixel);
  vec2 weight = (vec2(at) + 0.5) / vec2(face.zw);
  vec4 sum = vec4(0.0);  // toward right, up, left, down
  if (at.x + 1 < face.z) sum.x = weight.x * gap(here, pixel + ivec2(1, 0));
  if (at.y + 1 < face.w) sum.y = weight.y * gap(here, pixel + ivec2(0, 1));
  if (at.x > 0) sum.z = (1.0 - weight.x) * gap(here, pixel - ivec2(1, 0));
  if (at.y > 0) sum.w = (1.0 - weight.y) * gap(here, pixel - ivec2(0, 1));
  return sum;
}

// Counts a pixel of each invocation, with one atomic operation per work group that shows a single polygon, else one per
// run of equal pixels in a row.
void count(uint id, ivec2 pixel) {
  uint local = gl_LocalInvocationIndex, column = gl_LocalInvocationID.x;
  ids_of_group[local] = id;
  if (local == 0u) mixed = 0u;
  barrier();
  if (id != ids_of_group[0]) mixed = 1u;
  barrier();
  if (mixed == 0u) {
    if (local == 0u && id != hemicube_background) mark(id, pixel, hemicube_group_width * hemicube_group_height);
    return;
  }
  if (id == hemicube_background || (column > 0u && ids_of_group[local - 1u] == id)) return;
  uint length = 1u;
  while (column + length < hemicube_group_width && ids_of_group[local + length] == id) ++length;
  mark(id, pixel, length);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint local = gl_LocalInvocationIndex;
  uint id = hemicube_background;
  sums[local] = vec4(0.0);
  if (pixel.x < 3 * int(settings.resolution) && pixel.y < int(settings.resolution)) {
    // Where nothing was drawn the id may be that of an earlier hemicube.
    if (texelFetch(depths, pixel, 0).x > 0.0) id = texelFetch(ids, pixel, 0).x;
    sums[local] = importance(pixel);
  }
  count(id, pixel);
  // A tree in fixed order, so that the sum is always the same.
  for (uint half_size = hemicube_group_width * hemicube_group_height / 2u; half_size > 0u; half_size /= 2u) {
    barrier();
    if (local < half_size) sums[local] += sums[local + half_size];
  }
  if (local == 0u) group_sums[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = sums[0];
}
