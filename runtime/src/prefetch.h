#pragma once
// Requests the chunks of rows that a camera may need soon.
#include "db.h"

namespace sightcell::runtime {

// Implements sightcell_db_prefetch for finite numbers.
void prefetch(const sightcell_db& db, const point& eye, const point& velocity, double seconds) noexcept;

}  // namespace sightcell::runtime
