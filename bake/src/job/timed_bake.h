#pragma once
// A bake with a time budget: spends the time on the cells with the largest bounds, and writes a first file early.
#include <tbb/task_arena.h>

#include <filesystem>

#include "checkpoint/work_file.h"
#include "job/bake_context.h"
#include "job/cell_steps.h"
#include "sightcell/bake/bake.h"
#include "sightcell/base/time_budget.h"

namespace sightcell::bake {

// The objects that the bake works with. All outlive it.
struct timed_work {
  const bake_context& context;
  const stage_plan& plan;
  tbb::task_arena& arena;  // the calling thread is not inside of it
  time_budget& clock;
  work_file& file;  // for records, all of stage bounded: a record replaces the one before of its cell
  const std::filesystem::path& output;
  const callbacks& events;
};

// Bakes in passes with falling targets. In each pass every cell with a bound above the target has a turn, the largest
// bound first. Ends when all cells have reached the last target, when the budget is spent, or when the caller cancels.
// The output is first written after a tenth of the budget or a minute, whichever is less, then at the same interval,
// and at the end. From file to file sets only grow and bounds only fall. Cells without a bound are left out. sum:
// filled in. A canceled bake keeps its records. Throws sightcell::error "bake.time-budget" if no cell has a bound when
// the budget is spent.
void bake_in_time(const timed_work& work, summary& sum);

}  // namespace sightcell::bake
