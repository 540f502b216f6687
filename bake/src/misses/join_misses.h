#pragma once
// Adds reported misses to the set of a cell if they are confirmed.
#include <cstdint>
#include <span>

#include "bound/verification_rays.h"
#include "cell_set/cell_set.h"
#include "misses/misses_file.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Adds each reported polygon that the set lacks, with the reported eye as witness, if the eye is a valid viewpoint
// and a ray from it hits the polygon. Of several such eyes the first becomes the witness. Returns the number of rays
// cast. Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
std::uint64_t join_misses(const ray_scene& rays, const visibility_rules& rules, std::span<const reported_miss> misses,
                          cell_set& set);

}  // namespace sightcell::bake
