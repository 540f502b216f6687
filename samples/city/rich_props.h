#pragma once
// Props with fine parts, for the richer styles; in the order of `prop` from leafy_tree on.
#include <cstdint>
#include <vector>

#include "mesh.h"

namespace sightcell::city {

std::vector<mesh> make_rich_props(std::uint64_t seed);

}  // namespace sightcell::city
