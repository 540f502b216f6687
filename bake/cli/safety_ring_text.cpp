#include "safety_ring_text.h"

#include <fmt/format.h>

namespace sightcell::cli {

std::string safety_ring_text(const bake::summary& sum) {
  return fmt::format("safety ring: {:.1f} polygons per cell added unseen, {:.1f} % of what was seen",
                     sum.unseen_per_cell, sum.unseen_percent);
}

}  // namespace sightcell::cli
