#pragma once
// The two phases of a bake over some of its blocks (docs/method/determinism-and-sharding.md).
#include <tbb/task_arena.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "checkpoint/work_file.h"
#include "job/bake_context.h"
#include "job/cell_bake.h"
#include "job/cell_workers.h"
#include "job/progress_tracker.h"
#include "since/step_keeper.h"

namespace sightcell::bake {

// Returns the baker of the context's cells, which must outlive it.
cell_baker baker_of(const bake_context& context);
// Returns the workers that the source of hemicubes, the arena and the memory limit allow.
worker_pool workers_for(const bake_context& context, const cell_baker& baker, tbb::task_arena& arena,
                        stop_request& stop);

// Returns the record of a cell after phase 1. Called from several threads at a time.
using record_of_phase_1 = std::function<cell_record(std::uint32_t cell)>;

// The objects that a phase works with. All outlive it.
struct phase_work {
  const bake_context& context;
  const stage_plan& plan;
  std::span<const std::uint32_t> blocks;  // to bake, in this order; the order changes no record
  tbb::task_arena& arena;                 // the calling thread is not inside of it
  progress_tracker& tracker;
  work_file& file;                // where records are committed
  step_keeper* keeper = nullptr;  // takes steps from kept records and keeps records; null: all steps are baked
};

// Passes the records of an earlier run to the tracker, and reports how many cells are done.
void resume(checkpoint& done, progress_tracker& tracker, const callbacks& events);
// Returns the records of other cells, each without the polygons that own has already.
std::vector<cell_record> neighbors_of(const cell_record& own, std::span<const std::uint32_t> others,
                                      const record_of_phase_1& record_of);
// Logs how many cells an earlier run finished, and how many of its records are damaged.
void report_resume(std::uint32_t damaged, std::uint32_t resumed, std::uint32_t cells, const callbacks& events);
// Returns a record. Throws sightcell::error "checkpoint.failed" if it does not exist.
cell_record required(const checkpoint& done, std::uint32_t cell, cell_stage stage);
// Runs work. If it throws, first copies the checkpoint from the scratch folder, if there is one, to the output's
// folder.
void keeping(work_file& file, const std::function<void()>& work);

// Bakes the cells of each block in two rounds, until the bound of each is known. Reads no other file than work.file.
void run_phase_1(const phase_work& work);
// Runs the neighbor check across blocks and finishes the cells.
// before: the records of phase 1 of the cells and of their neighbors.
void run_phase_2(const phase_work& work, const record_of_phase_1& before);
// Runs both phases over all blocks. A cell is checked as soon as it and its neighbors are through phase 1, so that the
// checks are in the rate of the bake from early on, and with it in the time that is left. Reads no other file than
// work.file.
void run_both_phases(const phase_work& work);

}  // namespace sightcell::bake
