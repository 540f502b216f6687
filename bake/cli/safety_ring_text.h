#pragma once
// What bake and merge say of a safety ring.
#include <string>

#include "sightcell/bake/bake.h"

namespace sightcell::cli {

std::string safety_ring_text(const bake::summary& sum);

}  // namespace sightcell::cli
