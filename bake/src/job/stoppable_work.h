#pragma once
// Work that has no steps to report, such as building the structures of a scene.
#include <tbb/task_arena.h>

#include <functional>

#include "sightcell/base/stop_request.h"

namespace sightcell::bake {

// Runs work on a thread of its own inside the arena. Meanwhile calls report on the calling thread, several times per
// second. If report returns false or throws, asks stop, which work should look at. Throws step_stopped if work was to
// stop, once it has ended; else what report or work threw.
void run_stoppable(tbb::task_arena& arena, const std::function<void()>& work, const std::function<bool()>& report,
                   stop_request& stop);

}  // namespace sightcell::bake
