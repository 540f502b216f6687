#pragma once
// A walk through the cells of a file that calls all functions of a view and hashes their results. The hash is the same
// on every platform. web/walk.mjs is the same walk through the functions of the web module.
#include <cstdint>

#include "sightcell/sightcell.h"

namespace sightcell::test {

// Returns the hash of the results of some thousand moves of a view, and of the facts of db, which must have cells.
std::uint64_t hash_of_walk(const sightcell_db* db);

}  // namespace sightcell::test
