#pragma once
// Known misses into the set of a cell, as far as they are true.
#include <cstdint>
#include <span>

#include "bound/verification_rays.h"
#include "cell_set/cell_set.h"
#include "misses/misses_file.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Those of misses that the set lacks join it, with the eye as witness, where that is a free place and a ray from there
// sees the polygon; of several eyes that see it the first. Returns the rays cast. Runs on the calling thread's TBB
// arena; does not depend on the number of threads.
std::uint64_t join_misses(const ray_scene& rays, const visibility_rules& rules, std::span<const reported_miss> misses,
                          cell_set& set);

}  // namespace sightcell::bake
