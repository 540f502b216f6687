#pragma once
// Where a MASK material is there and where it is not: alpha over texture coordinates, one byte per texel. Rays and
// hemicubes ask the same texels with the same formula.
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "sightcell/scene/alpha_mode.h"

namespace sightcell::scene {

struct alpha_mask {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> texels;  // width x height alphas, rows from v = 0 on
  float cutoff = 0.5f;               // of texel / 255; the material's alphaCutoff divided by its constant alpha

  wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;

  // Bilinear between texel centers, at full resolution. uv is finite.
  float alpha(glm::vec2 uv) const;
  // Rule 1 of design.md section 4: the polygon is there, seen and occluding, where this is true. factor: the alpha of
  // vertex colors at that place.
  bool passes(glm::vec2 uv, float factor = 1.0f) const { return alpha(uv) * factor >= cutoff; }
};

// The mask at half the size in both directions, 2 x 2 means, rounded up to whole texels.
alpha_mask halved(const alpha_mask& mask);

}  // namespace sightcell::scene
