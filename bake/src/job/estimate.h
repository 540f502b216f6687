#pragma once
// How long a bake takes and how much it finds, estimated from a few cells before the first one is baked.
#include <cstddef>

#include "job/bake_context.h"

namespace sightcell::bake {

struct bake_estimate {
  double polygons = 0.0;  // visible in one hemicube of a cell, or in the trial of its sampler; mean over the trials
  double seconds = 0.0;   // of wall-clock time, for all cells that are left
};

// Times hemicubes, or the sampler's own rays, and verification rays in up to four cells spread over the list. Logs the
// result as a note. Changes nothing that the bake computes.
// cells_left: how many cells the estimate is for. 0: nothing is timed or logged, and the result is 0.
// Threads: works on the calling thread's TBB arena. Cost: four hemicubes or 262,144 rays, and a tenth of the
// verification rays of four cells, at most 131,072.
bake_estimate estimate_bake(const bake_context& context, std::size_t cells_left, const callbacks& events);

}  // namespace sightcell::bake
