#pragma once
// Clears the tiles of an image and tests against its hierarchical depth.
#include "hemicube/cpu/kernel.h"
#include "hemicube/cpu/lanes.h"

namespace sightcell::bake::cpu {
namespace {

constexpr std::uint32_t nothing = 0xFFFFFFFFu;  // scene::no_index

struct tile_rect {
  std::int32_t x0, y0, x1, y1;  // inclusive
};

inline void clear(const tile_image& image) {
  const std::uint32_t count = image.stride * image.tiles_y;
  for (std::uint32_t i = 0; i < count; i += 8) store(image.farthest + i, all(0.0f));
  for (std::uint32_t i = 0; i < count; ++i) image.states[i] = tile_state::empty;
}

// Initializes the memory of an empty tile.
inline void open_tile(const tile_image& image, std::uint32_t tile) {
  float* q = image.inverse_depths + std::size_t{tile} * tile_pixels;
  std::uint32_t* ids = image.ids + std::size_t{tile} * tile_pixels;
  for (std::uint32_t j = 0; j < tile_pixels; j += 8) {
    store(q + j, all(0.0f));
    store(ids + j, all(static_cast<std::int32_t>(nothing)));
  }
}

inline void refresh(const tile_image& image, std::uint32_t tile) {
  const float* q = image.inverse_depths + std::size_t{tile} * tile_pixels;
  floats least = load(q);
  for (std::uint32_t j = 8; j < tile_pixels; j += 8) least = smaller(least, load(q + j));
  image.farthest[tile] = smallest_lane(least);
  image.states[tile] = tile_state::exact;
}

// Returns true if everything at the inverse depth nearest or further away is occluded in the whole rectangle.
inline bool is_occluded(const tile_image& image, const tile_rect& rect, float nearest) {
  const floats limit = all(nearest);
  for (std::int32_t y = rect.y0; y <= rect.y1; ++y) {
    const std::uint32_t row = static_cast<std::uint32_t>(y) * image.stride;
    for (std::int32_t x = rect.x0 & ~7; x <= rect.x1; x += 8) {
      std::uint32_t open = sign_bits(limit > load(image.farthest + row + static_cast<std::uint32_t>(x)));
      if (x < rect.x0) open &= 0xFFu << (rect.x0 - x);
      if (x + 7 > rect.x1) open &= 0xFFu >> (x + 7 - rect.x1);
      for (; open != 0; open &= open - 1) {
        const std::uint32_t tile = row + static_cast<std::uint32_t>(x + __builtin_ctz(open));
        if (image.states[tile] != tile_state::stale) return false;
        refresh(image, tile);
        if (nearest > image.farthest[tile]) return false;
      }
    }
  }
  return true;
}

inline void count(const polygon_counter& counter, std::uint32_t id, std::uint32_t pixels, std::uint32_t first) {
  polygon_pixels& p = counter.by_id[id];
  if (p.pixels == 0) {
    p.first = first;
    counter.found[id / 64] |= std::uint64_t{1} << (id % 64);
  } else if (first < p.first) {
    p.first = first;
  }
  p.pixels += pixels;
}

inline std::uint32_t atlas_pixel(const face_frame& face, std::uint32_t x, std::uint32_t y) {
  return (face.atlas_y + y) * face.atlas_width + face.atlas_x + x;
}

}  // namespace
}  // namespace sightcell::bake::cpu
