// Tests against the hierarchical depth.
layout(binding = hemicube_texture_levels) uniform sampler2D levels;

// Factor by which a depth is taken as nearer: the possible error of the rasterizer's interpolation.
const float depth_slack = 1.001;
// What covers more blocks of the coarsest level than this on a side is not tested.
const int most_blocks = 16;

// Returns whether every pixel of a box is nearer than a distance along the axis of the face.
// low, high: in pixels of the face; clamped to it, so that a box beside it keeps the pixels of its border.
// most: blocks on a side at the level that is read, where one has so few.
// A comparison with NaN fails, and the result is false.
bool occluded(vec2 low, vec2 high, hemicube_cull_face face, float nearest, float near, int most) {
  ivec2 first_of_face = ivec2(face.pixels.xy), last_of_face = first_of_face + ivec2(face.pixels.zw) - 1;
  ivec2 first = first_of_face + ivec2(floor(clamp(low - 1.0, vec2(0.0), face.pixels.zw)));
  ivec2 last = first_of_face + ivec2(floor(clamp(high + 1.0, vec2(0.0), face.pixels.zw)));
  first = min(first, last_of_face);
  last = min(last, last_of_face);

  int level = 1;
  while (level < int(hemicube_depth_levels) && any(greaterThanEqual((last >> level) - (first >> level), ivec2(most))))
    ++level;
  first >>= level;
  last >>= level;
  if (any(greaterThanEqual(last - first, ivec2(most_blocks)))) return false;
  float depth = depth_slack * near / nearest;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      if (!(texelFetch(levels, ivec2(x, y), level).x > depth)) return false;
    }
  }
  return true;
}
