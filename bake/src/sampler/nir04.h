#pragma once
// Nirenstein and Blake, Hardware Accelerated Visibility Preprocessing using Adaptive Sampling (EGSR 2004), as compared
// with in the thesis: a face of the cell is divided into quads with a hemicube at each corner; where the corners of a
// quad see different polygons, it is divided into four.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "search/hemicubes.h"
#include "sightcell/base/box.h"

namespace sightcell::bake {

// What a corner sees, with pixels; ascending ids.
using corner_view = std::vector<seen_polygon>;

// How much of the picture is at stake between the corners of a quad, 0..1: over the corners, the largest share of a
// hemicube's pixels that polygons cover which another corner sees and it does not. pixels: of a whole hemicube. Fewer
// than two corners: 0.
double quad_difference(std::span<const corner_view* const> corners, double pixels);

struct nir04_options {
  double difference = 0.0;          // quads with no larger one are not divided
  std::uint32_t part_polygons = 0;  // a box that sees more of them is sampled again in halves; 0: never
};

// Takes hemicubes until none is left or no quad is worth dividing: of all faces the quad first whose difference times
// area is largest. Quads begin as 2 x 2 per face where there are nine hemicubes for each, else as one, else a hemicube
// stands in the middle. The result does not depend on threads.
void sample_nir04(const nir04_options& how, const box& grown, const std::function<bool(const glm::vec3&)>& is_free,
                  hemicubes& cell);

}  // namespace sightcell::bake
