#version 450 core
#include "shared/hemicube_layout.h"

// Hierarchical depth (Greene et al. 1993). Level 0 is a copy of the depth image; each pixel of a coarser level is the
// farthest of the four below it. Depth is reversed, so the farthest is the smallest. A block at a border repeats the
// last row or column of the atlas. A block that covers two faces uses the farthest depth of both, which culls less.
layout(local_size_x = 16, local_size_y = 16) in;

layout(binding = hemicube_texture_depth) uniform sampler2D depths;
layout(binding = hemicube_image_level, r32f) writeonly uniform image2D levels[hemicube_depth_levels + 1u];

shared float farthest[16][16];

void main() {
  ivec2 at = ivec2(gl_LocalInvocationID.xy), group = ivec2(gl_WorkGroupID.xy);
  ivec2 last = textureSize(depths, 0) - 1;
  float value = 3.4e38;
  for (int k = 0; k < 4; ++k) {
    ivec2 pixel = 2 * (16 * group + at) + ivec2(k & 1, k >> 1);
    float depth = texelFetch(depths, min(pixel, last), 0).x;
    imageStore(levels[0], pixel, vec4(depth));
    value = min(value, depth);
  }
  imageStore(levels[1], 16 * group + at, vec4(value));
  farthest[at.y][at.x] = value;
  int size = 16;
  // Image indices are constant, because devices need not support dynamic ones.
#define NEXT_LEVEL(level)                                                                                        \
  size /= 2;                                                                                                     \
  barrier();                                                                                                     \
  if (at.x < size && at.y < size) {                                                                              \
    value = min(min(farthest[2 * at.y][2 * at.x], farthest[2 * at.y][2 * at.x + 1]),                             \
                min(farthest[2 * at.y + 1][2 * at.x], farthest[2 * at.y + 1][2 * at.x + 1]));                    \
    imageStore(levels[level], size * group + at, vec4(value));                                                   \
  }                                                                                                              \
  barrier();                                                                                                     \
  if (at.x < size && at.y < size) farthest[at.y][at.x] = value;
  NEXT_LEVEL(2)
  NEXT_LEVEL(3)
  NEXT_LEVEL(4)
  NEXT_LEVEL(5)
}
