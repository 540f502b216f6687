#pragma once
// Measures what the sets of the lights of a .pvs file miss (docs/lights.md), with rays and random numbers of its own,
// as verify.h does for its cells.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/verify.h"

namespace sightcell::bake {

struct light_verification {
  double confidence = 0.95;         // of the upper bound
  std::uint32_t lights = 0;         // measured
  std::uint32_t inside_solids = 0;  // further lights: nothing is measured there
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;  // rays that meet a polygon inside range and cone that the set of the light lacks
  double upper_bound = 1.0;  // of the probability of a miss over all measured lights, one-sided Clopper-Pearson
  // Polygons that sets lack, those of the most rays first, at most 100. cell: the number of the light; target: a lit
  // point.
  std::vector<missing_polygon> missing;
};

// Verifies the lights of a file: casts rays from the position of each light in uniform directions.
// s, file, name, how, on_progress: as for verify(); how.metric and how.cells are not used. how.rays: over all lights.
// Fails with pvs.no-lights, and as verify().
light_verification verify_lights(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                                 const verify_settings& how, const verify_progress& on_progress);

}  // namespace sightcell::bake
