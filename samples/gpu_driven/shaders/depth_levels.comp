#version 450 core
// Five levels of the hierarchical depth from a depth image or from the level before them. A texel has the farthest of
// the four below it; depth is reversed, so the farthest is the smallest. Texels beside the picture are no limit.
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0) uniform sampler2D source;
layout(binding = 0, r32f) writeonly uniform image2D levels[5];

layout(location = 0) uniform int source_level;
layout(location = 1) uniform int level_count;

const float no_limit = 3.4e38;
shared float farthest[16][16];

void main() {
  ivec2 at = ivec2(gl_LocalInvocationID.xy), group = ivec2(gl_WorkGroupID.xy);
  ivec2 size = textureSize(source, source_level);
  float value = no_limit;
  for (int k = 0; k < 4; ++k) {
    ivec2 texel = 2 * (16 * group + at) + ivec2(k & 1, k >> 1);
    if (all(lessThan(texel, size))) value = min(value, texelFetch(source, texel, source_level).x);
  }
  imageStore(levels[0], 16 * group + at, vec4(value));
  farthest[at.y][at.x] = value;
  int side = 16;
  // Image indices are constant, because devices need not support dynamic ones.
#define NEXT_LEVEL(level)                                                                                        \
  side /= 2;                                                                                                     \
  barrier();                                                                                                     \
  if (at.x < side && at.y < side) {                                                                              \
    value = min(min(farthest[2 * at.y][2 * at.x], farthest[2 * at.y][2 * at.x + 1]),                             \
                min(farthest[2 * at.y + 1][2 * at.x], farthest[2 * at.y + 1][2 * at.x + 1]));                    \
    if (level < level_count) imageStore(levels[level], side * group + at, vec4(value));                          \
  }                                                                                                              \
  barrier();                                                                                                     \
  if (at.x < side && at.y < side) farthest[at.y][at.x] = value;
  NEXT_LEVEL(1)
  NEXT_LEVEL(2)
  NEXT_LEVEL(3)
  NEXT_LEVEL(4)
}
