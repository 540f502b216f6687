#pragma once
#include <algorithm>

#include "sightcell/bake/settings.h"

namespace sightcell::bake {

// Returns the miss probability that the first round of a bake aims at. With a time budget it is one that every cell
// reaches soon, so that no cell is left without a bound.
inline double first_target(const settings& how) {
  return how.time_budget > 0.0 ? std::max(1e-2, how.max_pixel_error) : how.max_pixel_error;
}

}  // namespace sightcell::bake
