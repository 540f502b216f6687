#pragma once
// The draw table of a scene before its draws are reordered.
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Returns one record for each draw. first_stored is that of the source order.
// layout: for `merged`, draws are in groups (in_groups() in stored_draws.h) of draws that the host issues with one
//   state and always shows together.
std::vector<format::draw_record> draw_table(const scene::scene& s, format::host_layout layout);

}  // namespace sightcell::bake
