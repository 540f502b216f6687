#pragma once
// Several cells in work at once.
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "cell_set/cell_set.h"
#include "checkpoint/checkpoint.h"
#include "job/cell_steps.h"

namespace sightcell::bake {

// How many cells are in work at once: one per thread where the source is shared, one where it is not. Every lane has a
// cell set, which is as large as the scene; where they would take more than a gibibyte together there are fewer lanes,
// and the other threads help inside of cells.
std::size_t worker_count(bool shared, int threads, std::size_t set_bytes);

// What a lane does: one step, in a set that is its own.
using take_step = std::function<cell_record(const cell_step& step, cell_set& set)>;

// Commits records of steps and tells of them; all that have ended since the last call. in_work: how many others lanes
// are busy with. False: no further step is begun.
using steps_ended = std::function<bool(std::span<stage_record> ended, std::size_t in_work)>;

// Takes the steps of the queue, so many lanes at once, on the arena. All calls of ended come on the calling thread, one
// at a time; a step counts as committed when it has returned. The calling thread must not be inside of the arena.
//
// When ended answers false or throws, and when a step throws, no further step is begun; those in work come to their end
// and ended is called for them too. Then the first of what was thrown is thrown from here. With one lane all of it
// happens on the calling thread, as a source that is not shared demands, one step after the other.
void take_steps(step_queue& queue, const std::function<cell_set()>& make_set, const take_step& take, std::size_t lanes,
                tbb::task_arena& arena, const steps_ended& ended);

}  // namespace sightcell::bake
