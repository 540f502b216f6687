#pragma once
// Procedural base-color textures for the textured variants, one per surface, and the coordinates that go with them.
#include <array>
#include <cstdint>
#include <vector>

#include "mesh.h"

namespace sightcell::city {

struct texture {
  std::vector<std::uint8_t> png;  // RGBA; the material's color is multiplied with it
};

std::vector<texture> make_textures();  // by surface number

// True where a polygon takes the whole texture, corner to corner: cut-outs by alpha.
bool is_cut_out(surface material);

// One per position. Walls run along their own direction, all else lies in plan; cut-outs are quads.
std::vector<std::array<float, 2>> texture_coordinates(const primitive& p);

}  // namespace sightcell::city
