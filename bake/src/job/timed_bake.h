#pragma once
// A bake that spends a time budget where the error is largest, and soon has a file to show for it.
#include <tbb/task_arena.h>

#include <filesystem>

#include "checkpoint/work_file.h"
#include "job/bake_context.h"
#include "job/cell_steps.h"
#include "sightcell/bake/bake.h"
#include "sightcell/base/time_budget.h"

namespace sightcell::bake {

// What it works with; all outlive it.
struct timed_work {
  const bake_context& context;
  const stage_plan& plan;
  tbb::task_arena& arena;  // the calling thread is not inside of it
  time_budget& clock;
  work_file& file;  // where records are committed, all of stage bounded: the next one of a cell replaces the last
  const std::filesystem::path& output;
  const callbacks& tell;
};

// Passes over the cells to falling targets: each cell that is above it has a turn, the largest bound first. Ends when
// all have reached the last target, when the clock says so, or when the user does. The output is written with the first
// turn that ends after a tenth of the budget, or a minute where that is less, then as often again, and in the end: its
// sets only grow and its bounds only fall, and cells without a bound are not in it. Fills in the summary; what was
// cancelled keeps its records. Throws sightcell::error, "bake.time-budget" where no cell has come to a bound.
void bake_in_time(const timed_work& work, summary& sum);

}  // namespace sightcell::bake
