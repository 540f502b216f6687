#include "sightcell/scene/alpha_mask.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sightcell::scene {
namespace {

// The two texels on both sides of a coordinate, and the weight of the second.
struct between {
  std::uint32_t first, second;
  float toward_second;
};

// Maps a coordinate into 0..1.
float folded(float coordinate, wrap mode) {
  if (mode == wrap::clamp) return std::clamp(coordinate, 0.0f, 1.0f);
  if (mode == wrap::mirror) return std::abs(coordinate - 2.0f * std::floor((coordinate + 1.0f) * 0.5f));
  return coordinate - std::floor(coordinate);
}

// shaders/hemicube/masked.frag does the same in the same order.
between texels_at(float coordinate, std::uint32_t size, wrap mode) {
  const float place = folded(coordinate, mode) * static_cast<float>(size) - 0.5f;
  const float below = std::floor(place);  // -1 for the half texel before the first center
  const std::uint32_t last = size - 1;
  const std::uint32_t before_first = mode == wrap::repeat ? last : 0, after_last = mode == wrap::repeat ? 0 : last;
  const std::uint32_t first = below < 0.0f ? before_first : std::min(static_cast<std::uint32_t>(below), last);
  const std::uint32_t second = below < 0.0f ? 0 : first == last ? after_last : first + 1;
  return {first, second, place - below};
}

}  // namespace

float alpha_mask::alpha(glm::vec2 uv) const {
  const between x = texels_at(uv.x, width, wrap_u), y = texels_at(uv.y, height, wrap_v);
  const auto texel = [&](std::uint32_t column, std::uint32_t row) {
    return static_cast<float>(texels[std::size_t{row} * width + column]);
  };
  const float low = texel(x.first, y.first) + (texel(x.second, y.first) - texel(x.first, y.first)) * x.toward_second;
  const float high =
      texel(x.first, y.second) + (texel(x.second, y.second) - texel(x.first, y.second)) * x.toward_second;
  return (low + (high - low) * y.toward_second) / 255.0f;
}

alpha_mask halved(const alpha_mask& mask) {
  alpha_mask out{(mask.width + 1) / 2, (mask.height + 1) / 2, {}, mask.cutoff, mask.wrap_u, mask.wrap_v};
  out.texels.resize(std::size_t{out.width} * out.height);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      unsigned sum = 0;
      for (std::uint32_t dy = 0; dy < 2; ++dy) {
        for (std::uint32_t dx = 0; dx < 2; ++dx) {
          const std::size_t row = std::min(2 * y + dy, mask.height - 1);
          sum += mask.texels[row * mask.width + std::min(2 * x + dx, mask.width - 1)];
        }
      }
      out.texels[std::size_t{y} * out.width + x] = static_cast<std::uint8_t>((sum + 2) / 4);
    }
  }
  return out;
}

}  // namespace sightcell::scene
