#pragma once
// Measures what the shadow casters of a .pvs file miss (docs/shadows.md), with rays and random numbers of its own, as
// verify.h does for its sets.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/verify.h"

namespace sightcell::bake {

// Result for one sun of the file.
struct sun_verification {
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;  // rays that show a point without its shadow
  double upper_bound = 1.0;  // of the probability of a miss over all cells, one-sided Clopper-Pearson
  // For comparison: rays that show a point without its shadow where a host draws the sets of the cells alone.
  std::uint64_t misses_of_sets = 0;
  double set_percent = 0.0;    // mean size of the measured sets, percent of all polygons
  double drawn_percent = 0.0;  // the same with the casters
  std::vector<cell_verification> cells;
};

struct caster_verification {
  double confidence = 0.95;            // of all upper bounds
  std::vector<sun_verification> suns;  // in the order of the file
  // Polygons without which shadows are missing: of each, the one nearest to the point. Those of the most rays first, at
  // most 100. target: a point without its shadow.
  std::vector<missing_polygon> missing;
};

// Verifies the casters of a file. s, file, name, how, on_progress: as for verify(); how.metric is not used, because
// directions are uniform. how.rays: of each sun.
// Fails with pvs.no-casters, and as verify().
caster_verification verify_casters(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                                   const verify_settings& how, const verify_progress& on_progress);

}  // namespace sightcell::bake
