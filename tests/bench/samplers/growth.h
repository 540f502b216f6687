#pragma once
// How a cell's set grows while one of its faces is sampled.
#include <cstdint>
#include <string>
#include <vector>

#include "bench/samplers/ground.h"
#include "bench/samplers/jobs.h"
#include "search/boundary_face.h"

namespace sightcell::bench {

// How many polygons are seen after the first, second, ... hemicube that the sampler puts on that face, at most
// what.how.samples. The sampler works over the whole cell with six times as many, but sees nothing from other faces.
std::vector<std::uint32_t> growth_of_face(const ground& g, std::size_t cell, const job& what,
                                          const bake::boundary_face& face, bake::hemicube_source& source);

}  // namespace sightcell::bench
