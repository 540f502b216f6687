#pragma once
// Finds the pairs of polygons that artists use for leaves: two in the same place that face opposite ways.
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Rule 1 of docs/method/visibility-rules.md: makes single-sided MASK polygons double-sided if they have the same
// three corners and are wound in both ways. Otherwise rays and pixels that hit both at the same distance would choose
// by rounding.
void join_opposite_pairs(world_geometry& geometry);

}  // namespace sightcell::scene
