// The alpha test of MASK polygons, from the outputs of masked.vert. The formula is that of
// bake/scene/src/alpha_mask.cpp, in the same order of operations.
layout(std430, binding = hemicube_buffer_masks) readonly buffer masks_buffer { hemicube_mask masks[]; };
layout(std430, binding = hemicube_buffer_texels) readonly buffer texels_buffer { uint texels[]; };

flat in uint polygon_mask;
in vec2 place;
in float place_alpha;

float texel(hemicube_mask mask, uint column, uint row) {
  uint at = mask.first_texel + row * mask.width + column;
  return float((texels[at / 4u] >> (8u * (at % 4u))) & 0xFFu);
}

float folded(float coordinate, uint wrap) {
  if (wrap == 1u) return clamp(coordinate, 0.0, 1.0);
  if (wrap == 2u) return abs(coordinate - 2.0 * floor((coordinate + 1.0) * 0.5));
  return coordinate - floor(coordinate);
}

// Returns the two texels that a coordinate is between.
uvec2 texels_at(float coordinate, uint size, uint wrap, out float toward_second) {
  float at = folded(coordinate, wrap) * float(size) - 0.5;
  float below = floor(at);
  toward_second = at - below;
  uint last = size - 1u;
  uint before_first = wrap == 0u ? last : 0u, after_last = wrap == 0u ? 0u : last;
  uint first = below < 0.0 ? before_first : min(uint(below), last);
  return uvec2(first, below < 0.0 ? 0u : first == last ? after_last : first + 1u);
}

bool alpha_passes() {
  hemicube_mask mask = masks[polygon_mask];
  float right, down;
  uvec2 x = texels_at(place.x, mask.width, mask.wrap_u, right);
  uvec2 y = texels_at(place.y, mask.height, mask.wrap_v, down);
  float low = texel(mask, x.x, y.x) + (texel(mask, x.y, y.x) - texel(mask, x.x, y.x)) * right;
  float high = texel(mask, x.x, y.y) + (texel(mask, x.y, y.y) - texel(mask, x.x, y.y)) * right;
  return (low + (high - low) * down) / 255.0 * place_alpha >= mask.cutoff;
}
