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
#include "job/progress_tracker.h"

namespace sightcell::bake {

// Made in place: it cannot be moved.
cell_baker baker_of(const bake_context& context);
// So many cells are in work at once.
std::size_t workers_of(const bake_context& context, const cell_baker& baker, const tbb::task_arena& arena);

// What phase 1 left of a cell; called from many threads.
using record_of_phase_1 = std::function<cell_record(std::uint32_t cell)>;

// What a phase works with; all outlive it.
struct phase_work {
  const bake_context& context;
  const stage_plan& plan;
  std::span<const std::uint32_t> blocks;  // in this order; it changes no record
  tbb::task_arena& arena;                 // the calling thread is not inside of it
  progress_tracker& tracker;
  work_file& file;  // where records are committed
};

// What an earlier run left, into the book; says how much that is.
void resume(checkpoint& done, progress_tracker& tracker, const callbacks& tell);
// What others see and own does not, one after the other.
std::vector<cell_record> neighbors_of(const cell_record& own, std::span<const std::uint32_t> others,
                                      const record_of_phase_1& record_of);
// Says how many records of an earlier run there are, and how many were damaged.
void tell_of_resume(std::uint32_t damaged, std::uint32_t resumed, std::uint32_t cells, const callbacks& tell);
// A record that must be there.
cell_record required(const checkpoint& done, std::uint32_t cell, cell_stage stage);
// Runs work and leaves a copy of the file where that is asked for, however work ends.
void keeping(work_file& file, const std::function<void()>& work);

// Cells of each block, in two rounds, until the bound of each is known. Reads from file alone.
void run_phase_1(const phase_work& work);
// The cross-cell check: reads what phase 1 left of the cells and of all that touch them.
void run_phase_2(const phase_work& work, const record_of_phase_1& before);

}  // namespace sightcell::bake
