#include "phases.h"

#include <fmt/format.h>

#include <vector>

#include "cell_bake.h"
#include "cell_lanes.h"
#include "sightcell/scene/error.h"

namespace sightcell::bake {
namespace {

// Made in place: it cannot be moved.
cell_baker baker_of(const workshop& shop) {
  return {shop.how, shop.given, *shop.rays, shop.neighbors ? &*shop.neighbors : nullptr, *shop.eyes.source};
}

void run(const phase_work& work, const cell_baker& baker, step_queue queue, const take_step& take) {
  const std::size_t lanes =
      lane_count(work.shop.eyes.source->shared(), work.arena.max_concurrency(), baker.set_bytes());
  take_steps(
      queue, [&] { return baker.make_set(); }, take, lanes, work.arena,
      [&](std::span<const stage_record> ended, std::size_t in_work) {
        return work.book.close(ended, in_work, work.done);
      });
}

}  // namespace

void run_phase_1(const phase_work& work) {
  if (work.book.stopped()) return;
  const cell_baker baker = baker_of(work.shop);
  const auto sampled = [&](std::uint32_t cell) {
    std::optional<cell_record> record = work.done.load(cell, cell_stage::sampled);
    if (!record)
      throw error(error_kind::failed, "checkpoint.failed", "checkpoint", "a record is gone",
                  "run the same command again");
    return std::move(*record);
  };
  const take_step take = [&](const cell_step& step, cell_set& set) {
    const view_cell& cell = work.shop.list.cells[step.cell];
    if (step.to == cell_stage::sampled) return baker.sample(cell, set);
    if (work.plan.shares_in_block(step.cell)) {
      std::vector<cell_record> neighbors;
      for (const std::uint32_t other : work.plan.blocks().neighbors_in_block(step.cell))
        neighbors.push_back(sampled(other));
      return baker.finish_rays(cell, sampled(step.cell), neighbors, set);
    }
    cell_record record = baker.sample_and_finish(cell, set);
    return step.to == cell_stage::finished ? baker.finished(cell, std::move(record)) : record;
  };
  run(work, baker, step_queue::phase_1(work.plan, work.book.have(), work.blocks), take);
}

void run_phase_2(const phase_work& work, const record_of_phase_1& before) {
  if (work.book.stopped()) return;
  const cell_baker baker = baker_of(work.shop);
  const take_step take = [&](const cell_step& step, cell_set& set) {
    const view_cell& cell = work.shop.list.cells[step.cell];
    cell_record own = before(step.cell);
    if (work.plan.end_of_phase_1(step.cell) == cell_stage::finished) return own;  // nobody is beside it
    std::vector<cell_record> neighbors;
    for (const std::uint32_t other : work.plan.blocks().neighbors_of(step.cell)) neighbors.push_back(before(other));
    return baker.finished(cell, baker.check(cell, own, neighbors, set));
  };
  run(work, baker, step_queue::phase_2(work.plan, work.book.have(), work.blocks), take);
}

}  // namespace sightcell::bake
