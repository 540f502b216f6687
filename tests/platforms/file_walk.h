#pragma once
// A walk through the cells of a file that asks all that a view can answer, as one hash that is the same on every
// platform; web/walk.mjs is the same walk through the functions of the web module.
#include <cstdint>

#include "sightcell/sightcell.h"

namespace sightcell::test {

// The answers to some thousand moves of a view, and what db says about itself; of a file with cells.
std::uint64_t hash_of_walk(const sightcell_db* db);

}  // namespace sightcell::test
