#pragma once
// A pool of workers that take the steps of a queue, several cells at a time.
#include <tbb/task_arena.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "cell_set/cell_set.h"
#include "checkpoint/checkpoint.h"
#include "job/cell_steps.h"
#include "job/steps_in_work.h"
#include "sightcell/base/stop_request.h"

namespace sightcell::bake {

// Returns the number of workers: one per thread. Each worker has a cell set, which is as large as the scene. If the
// sets would take more than 1 GiB together, there are fewer workers, and the other threads work on loops inside the
// cells. set_bytes: size of one set.
std::size_t worker_count(int threads, std::size_t set_bytes);

// Takes one step. set: working memory of the worker.
using take_step = std::function<cell_record(const cell_step& step, cell_set& set)>;

// Commits the records of all steps that have ended since the last call. Without records: time has passed, and a caller
// may want to know which steps are in work.
// in_work: the other steps that the workers are busy with.
// Returns false if no further step may begin.
using steps_ended = std::function<bool(std::span<stage_record> ended, std::span<const step_in_work> in_work)>;

struct worker_pool {
  tbb::task_arena& arena;
  stop_request& stop;       // made when `ended` returns false or throws: steps in work end soon, without a record
  std::size_t workers = 1;  // how many steps are taken at a time
  // The longest time between calls of `ended` while steps are in work. A cancel takes effect within twice this time.
  std::chrono::milliseconds pause{250};
};

// Takes the steps of the queue.
// make_set: makes the working memory of a worker.
// ended: called on the calling thread, one call at a time. Its steps count as committed when it returns.
// Failure: if ended returns false or throws, or if a step throws, no further step begins, and pool.stop is requested.
// Steps in work that throw step_stopped have no record; others come to their end, and ended is called for them too.
// Then the first exception is thrown again.
// Threads: the calling thread must not be inside the arena. A single worker begins a step when the one before is
// committed.
void take_steps(step_queue& queue, const std::function<cell_set()>& make_set, const take_step& take,
                const worker_pool& pool, const steps_ended& ended);

}  // namespace sightcell::bake
