#pragma once
// Nirenstein and Blake, Hardware Accelerated Visibility Preprocessing using Adaptive Sampling (EGSR 2004), as the
// thesis compares with it. A face of the cell is divided into quads with a hemicube at each corner. A quad whose
// corners show different polygons is divided into four.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "search/hemicubes.h"
#include "sightcell/base/box.h"

namespace sightcell::bake {

// The polygons that a corner shows, with pixels; ascending ids.
using corner_view = std::vector<seen_polygon>;

// Returns how different the corners of a quad are, 0..1: the maximum over the corners of the share of a hemicube's
// pixels with polygons that another corner shows and this one does not. 0 for fewer than two corners.
// pixels: of a whole hemicube.
double quad_difference(std::span<const corner_view* const> corners, double pixels);

// The parameters of nir04.
struct nir04_options {
  double difference = 0.0;          // quads up to this difference are not divided
  std::uint32_t part_polygons = 0;  // a box that shows more polygons is sampled again in halves; 0: never
};

// Renders hemicubes until none is left or no quad needs division. Of all faces the quad with the largest product of
// difference and area comes first. Faces begin as 2 x 2 quads if there are at least nine hemicubes per face, else as
// one quad, else with one hemicube in the middle. The result does not depend on threads.
// is_valid: returns whether a point is a valid viewpoint.
void sample_nir04(const nir04_options& how, const box& grown, const std::function<bool(const glm::vec3&)>& is_valid,
                  hemicubes& cell);

}  // namespace sightcell::bake
