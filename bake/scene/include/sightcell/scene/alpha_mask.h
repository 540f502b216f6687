#pragma once
// Where a MASK material is there and where it is not: alpha over texture coordinates, one byte per texel. Rays and
// hemicubes ask the same texels with the same formula.
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace sightcell::scene {

struct alpha_mask {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> texels;  // width x height alphas, rows from v = 0 on; repeats in both directions
  float cutoff = 0.5f;               // of texel / 255; the material's alphaCutoff divided by its constant alpha

  // Bilinear between texel centers, at full resolution. uv is finite.
  float alpha(glm::vec2 uv) const;
  // Rule 1 of design.md section 4: the polygon is there, seen and occluding, where this is true.
  bool passes(glm::vec2 uv) const { return alpha(uv) >= cutoff; }
};

// The mask at half the size in both directions, 2 x 2 means, rounded up to whole texels.
alpha_mask halved(const alpha_mask& mask);

}  // namespace sightcell::scene
