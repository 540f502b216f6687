#pragma once
// How long a bake takes and how much it finds, estimated from a few cells before the first one is baked.
#include <tbb/task_arena.h>

#include <cstddef>
#include <optional>

#include "job/bake_context.h"

namespace sightcell::bake {

struct bake_estimate {
  double polygons = 0.0;     // visible from a cell, or found by the trial of its sampler; mean over the trials
  double seconds = 0.0;      // of wall-clock time, for all cells that are left
  double cpu_seconds = 0.0;  // the same on all threads together
  // Of the file with all cells; nothing where it was not requested, or no whole cells were tried.
  std::optional<double> file_bytes;
};

// Bakes some cells that are spread over the list (choose_trials()), one in 25 but 8 to 32 of them, and drops the
// results. A sampler that uses rays alone is not tried with whole cells, because it may need all cells at a time: here
// its own rays and verification rays are timed in up to four cells. Trials of whole cells end after ten seconds. With a
// time budget they are sampled and not bounded. Logs the result as a note. Changes nothing that the bake computes.
// cells_left: how many cells the estimate is for. 0: nothing is timed or logged, and the result is 0.
//   Below 80 one in 10 is tried.
// with_file: whether to estimate the bytes of the file too, from the same cells (file_estimate.h).
// events: on_progress is called several times per second while cells are tried. Returns nothing if it cancels.
// Threads: the calling thread must not be inside the arena.
std::optional<bake_estimate> estimate_bake(const bake_context& context, std::size_t cells_left, tbb::task_arena& arena,
                                           const callbacks& events, bool with_file = false);

}  // namespace sightcell::bake
