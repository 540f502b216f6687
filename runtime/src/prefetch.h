#pragma once
// Which chunks of rows a camera may need soon.
#include "db.h"

namespace sightcell::runtime {

// What sightcell_db_prefetch does, for numbers that are finite.
void prefetch(const sightcell_db& db, const point& eye, const point& velocity, double seconds) noexcept;

}  // namespace sightcell::runtime
