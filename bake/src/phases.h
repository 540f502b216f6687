#pragma once
// The two phases of a bake over some of its blocks (design.md section 4).
#include <tbb/task_arena.h>

#include <cstdint>
#include <functional>
#include <span>

#include "checkpoint.h"
#include "ledger.h"
#include "workshop.h"

namespace sightcell::bake {

// What phase 1 left of a cell; called from many threads.
using record_of_phase_1 = std::function<cell_record(std::uint32_t cell)>;

// What a phase works with; all outlive it.
struct phase_work {
  const workshop& shop;
  const stage_plan& plan;
  std::span<const std::uint32_t> blocks;  // in this order; it changes no record
  tbb::task_arena& arena;                 // the calling thread is not inside of it
  ledger& book;
  checkpoint& done;  // where records are committed
};

// Cells of each block, in two rounds, until the bound of each is known. Reads from done alone.
void run_phase_1(const phase_work& work);
// The cross-cell check: reads what phase 1 left of the cells and of all that touch them.
void run_phase_2(const phase_work& work, const record_of_phase_1& before);

}  // namespace sightcell::bake
