#pragma once
// The mask of a material with alpha_mode::mask: alpha over texture coordinates, one byte per texel. Rays and hemicubes
// use the same texels and the same formula.
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "sightcell/scene/alpha_mode.h"

namespace sightcell::scene {

struct alpha_mask {
  std::uint32_t width = 0, height = 0;  // texels
  std::vector<std::uint8_t> texels;     // width * height, rows from v = 0 on
  float cutoff = 0.5f;                  // alphaCutoff / constant alpha of the material; compared with texel / 255
  wrap wrap_u = wrap::repeat;           // outside 0 .. 1
  wrap wrap_v = wrap::repeat;

  // Returns the alpha at a point, 0 .. 1: bilinear between texel centers, at full resolution.
  // uv: finite.
  float alpha(glm::vec2 uv) const;

  // Returns whether a polygon exists at a point: there it is visible and occludes (docs/method/visibility-rules.md,
  // rule 1).
  // factor: alpha of the vertex colors at this point.
  bool passes(glm::vec2 uv, float factor = 1.0f) const { return alpha(uv) * factor >= cutoff; }
};

// Returns the mask at half the size in both directions, rounded up to whole texels: means of 2 x 2 texels.
alpha_mask halved(const alpha_mask& mask);

}  // namespace sightcell::scene
