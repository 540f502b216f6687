#pragma once
// Ground that follows the relief: streets, pavements, sunken streets with walls and stairs, and bridges over them.
#include "mesh.h"
#include "plan.h"
#include "relief.h"

namespace sightcell::city {

// The open ground between the plan's nodes (row, column), sunken streets at its sides included.
void add_street_ground(mesh& m, const plan& p, const relief& r, std::uint32_t row, std::uint32_t column,
                       const block* content);

// The raised slab of a block and the lawn in its yard.
void add_pavement(mesh& m, const ring& outline, const relief& r);
void add_lawn(mesh& m, const ring& outline, const relief& r);

void add_bridge(mesh& m, const bridge& b, const relief& r);
double bridge_height(const bridge& b, const relief& r);  // of the deck over the crossing

// The wall's top line of the sunken street at a block's low-z or high-z side, walked so that the street is to the
// right.
std::array<glm::dvec2, 2> sunken_edge(const block& b, bool low_side);

}  // namespace sightcell::city
