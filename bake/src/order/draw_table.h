#pragma once
// The draw table of a scene before its draws are reordered.
#include <span>
#include <string>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Returns one record for each draw. first_stored is that of the source order.
// layout: for `merged`, draws are in groups (in_groups() in stored_draws.h) of draws that the host issues with one
//   state and always shows together.
std::vector<format::draw_record> draw_table(const scene::scene& s, format::host_layout layout);

// Removes named groups that a host must not hide, and numbers the others anew.
// closed: their names, in any order. Names that `names` does not have are ignored.
// names: of all groups; receives those that are left, in their order.
// draws: named_group is a place in names, before and after.
void remove_closed_groups(std::span<const std::string> closed, std::vector<std::string>& names,
                          std::span<format::draw_record> draws);

}  // namespace sightcell::bake
