#pragma once
// Artists give a leaf its back by a second polygon in the same place that faces the other way.
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Rule 1 of docs/method/visibility-rules.md: single-sided MASK polygons with the same three corners of which some are
// wound one way and some the other are taken as double-sided, all of them. Otherwise rays and pixels that meet both at
// the same distance choose by rounding.
void join_opposite_pairs(world_geometry& geometry);

}  // namespace sightcell::scene
