#pragma once
// The draw table of a scene, before its draws are put in order.
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// One record for each draw, first_stored in the order of the source. Merged: draws are in groups (in_groups of
// stored_draws.h) where the host draws them with one state and always shows them together.
std::vector<format::draw_record> draw_table(const scene::scene& s, format::host_layout layout);

}  // namespace sightcell::bake
