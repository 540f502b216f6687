#include "job/phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "job/memory_limit.h"
#include "search/neighbor_check.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr std::chrono::milliseconds report_pause{200};  // between reports while the sampler prepares

void run(const phase_work& work, const cell_baker& baker, bake_phase phase, step_queue queue, stop_request& stop,
         const take_step& take) {
  if (queue.count() == 0) return;
  work.tracker.begin(phase);
  take_steps(
      queue, [&] { return baker.make_set(); }, take, workers_for(work.context, baker, work.arena, stop),
      [&](std::span<const stage_record> ended, std::span<const step_in_work> in_work) {
        const bool proceed = work.tracker.close(ended, in_work, work.file.records());
        work.file.copy_if_due();
        return proceed;
      });
}

// Runs the part of the sampler that covers all cells together, if any cell of the blocks has to be sampled still. Each
// resume and each shard repeats all of it, so that it does not depend on which cells are left.
// Returns false if the caller canceled.
bool prepare(const phase_work& work) {
  const cell_blocks& all = work.plan.blocks();
  const auto sampled = [&](std::uint32_t cell) {
    return work.tracker.have().has(cell, cell_stage::sampled) || work.plan.through_phase_1(work.tracker.have(), cell);
  };
  if (std::all_of(work.blocks.begin(), work.blocks.end(), [&](std::uint32_t block) {
        const auto cells = all.cells_of(block);
        return std::all_of(cells.begin(), cells.end(), sampled);
      }))
    return true;
  using clock = std::chrono::steady_clock;
  clock::time_point reported = clock::now();
  work.arena.execute([&] {
    work.context.sampler->prepare([&](double share) {
      work.tracker.begin(bake_phase::preparing_sampler);
      if (clock::now() - reported < report_pause) return true;
      reported = clock::now();
      return work.tracker.preparing(share);
    });
  });
  return !work.tracker.stopped();
}

// The records of the neighbors of a cell, loaded when they are first needed: an incremental bake needs few of them.
class lazy_neighbors {
 public:
  explicit lazy_neighbors(std::function<std::vector<cell_record>()> load) : load_(std::move(load)) {}
  std::span<const cell_record> operator()() {
    if (!records_) records_ = load_();
    return *records_;
  }

 private:
  std::function<std::vector<cell_record>()> load_;
  std::optional<std::vector<cell_record>> records_;
};

std::span<const cell_record> no_neighbors() {
  return {};
}

cell_record take_or_bake(const phase_work& work, const view_cell& cell, step_kind kind, const cell_record* own,
                         const neighbor_records& neighbors, const bake_step& bake) {
  return work.keeper ? work.keeper->take(cell, kind, own, neighbors, bake) : bake(nullptr);
}

cell_record step_of_phase_1(const phase_work& work, const cell_baker& baker, const cell_step& step, cell_set& set,
                            stop_request& stop) {
  const view_cell& cell = work.context.cells->list.cells[step.cell];
  const auto sampled = [&](std::uint32_t of) { return required(work.file.records(), of, cell_stage::sampled); };
  if (step.to == cell_stage::sampled)
    return take_or_bake(work, cell, step_kind::sample, nullptr, no_neighbors,
                        [&](const found_before* before) { return baker.sample(cell, set, &stop, before); });
  if (work.plan.shares_in_block(step.cell)) {
    const cell_record own = sampled(step.cell);
    const auto around = work.plan.blocks().neighbors_in_block(step.cell);
    lazy_neighbors neighbors([&] { return neighbors_of(own, around, sampled); });
    return take_or_bake(work, cell, step_kind::finish_rays, &own, std::ref(neighbors), [&](const found_before* before) {
      const auto others = before ? std::span<const cell_record>() : neighbors();
      return baker.finish_rays(cell, own, others, set, &stop, before);
    });
  }
  cell_record record =
      take_or_bake(work, cell, step_kind::sample_and_finish, nullptr, no_neighbors,
                   [&](const found_before* before) { return baker.sample_and_finish(cell, set, &stop, before); });
  return step.to == cell_stage::finished ? baker.finished(cell, std::move(record)) : record;
}

// The step of phase 2 of a cell. before: the records of phase 1.
cell_record check(const phase_work& work, const cell_baker& baker, const record_of_phase_1& before,
                  std::uint32_t number, cell_set& set, stop_request& stop) {
  const cell_blocks& blocks = work.plan.blocks();
  const view_cell& cell = work.context.cells->list.cells[number];
  cell_record own = before(number);
  if (work.plan.end_of_phase_1(number) == cell_stage::finished) return own;  // it touches no other cell
  const record_of_phase_1 untested = [&](std::uint32_t other) {
    cell_record record = before(other);
    if (blocks.block_of(other) == blocks.block_of(number)) keep_late(record);
    return record;
  };
  lazy_neighbors neighbors([&] { return neighbors_of(own, blocks.neighbors_of(number), untested); });
  const bake_step bake = [&](const found_before* start) {
    return start ? baker.keep_checked(own, *start, set, &stop) : baker.check(cell, own, neighbors(), set, &stop);
  };
  return baker.finished(cell, take_or_bake(work, cell, step_kind::check, &own, std::ref(neighbors), bake));
}

}  // namespace

cell_baker baker_of(const bake_context& context) {
  return {context.how,
          context.input.given,
          context.traced->rays,
          context.traced->neighbors_or_null(),
          context.traced->duplicates,
          *context.sampler,
          context.device->metric,
          &context.input.misses,
          context.s.polygon_count,
          context.volumes_or_null()};
}

worker_pool workers_for(const bake_context& context, const cell_baker& baker, tbb::task_arena& arena,
                        stop_request& stop) {
  const std::size_t most = worker_count(arena.max_concurrency(), baker.set_bytes());
  const std::uint64_t worker_bytes =
      memory_of_worker(context.input.geometry.kinds.size(), baker.set_bytes(), context.how);
  return {.arena = arena, .stop = stop, .workers = workers_that_fit(most, worker_bytes, context.how)};
}

std::vector<cell_record> neighbors_of(const cell_record& own, std::span<const std::uint32_t> others,
                                      const record_of_phase_1& record_of) {
  std::vector<cell_record> neighbors;
  for (const std::uint32_t other : others) drop_known(own.set, neighbors.emplace_back(record_of(other)));
  return neighbors;
}

void resume(checkpoint& done, progress_tracker& tracker, const callbacks& events) {
  const std::uint32_t damaged = done.survey(
      [&](std::uint32_t cell, cell_stage stage, const cell_summary& record) { tracker.resume(cell, stage, record); });
  report_resume(damaged, tracker.resumed(), tracker.cells_total(), events);
}

void report_resume(std::uint32_t damaged, std::uint32_t resumed, std::uint32_t cells, const callbacks& events) {
  if (!events.on_message) return;
  if (damaged > 0)
    events.on_message(
        severity::warning,
        fmt::format("{} records of the unfinished bake are damaged: their cells are baked anew", damaged));
  if (resumed > 0) events.on_message(severity::note, fmt::format("resuming: {} of {} cells are done", resumed, cells));
}

cell_record required(const checkpoint& done, std::uint32_t cell, cell_stage stage) {
  std::optional<cell_record> record = done.load(cell, stage);
  if (!record)
    throw error(error_kind::failed, "checkpoint.failed", fmt::format("cell {}", cell), "its record is gone",
                "run the same command again");
  return std::move(*record);
}

void keeping(work_file& file, const std::function<void()>& work) {
  try {
    work();
  } catch (...) {
    try {
      file.copy();
    } catch (const error&) {
      // The first exception is the one that the user sees. The scratch folder still has all records.
    }
    throw;
  }
}

void run_phase_1(const phase_work& work) {
  if (work.tracker.stopped() || !prepare(work)) return;
  const cell_baker baker = baker_of(work.context);
  stop_request stop;
  run(work, baker, bake_phase::baking_cells, step_queue::phase_1(work.plan, work.tracker.have(), work.blocks), stop,
      [&](const cell_step& step, cell_set& set) { return step_of_phase_1(work, baker, step, set, stop); });
}

void run_phase_2(const phase_work& work, const record_of_phase_1& before) {
  if (work.tracker.stopped()) return;
  const cell_baker baker = baker_of(work.context);
  stop_request stop;
  run(work, baker, bake_phase::checking_neighbors, step_queue::phase_2(work.plan, work.tracker.have(), work.blocks),
      stop, [&](const cell_step& step, cell_set& set) { return check(work, baker, before, step.cell, set, stop); });
}

void run_both_phases(const phase_work& work) {
  if (work.tracker.stopped() || !prepare(work)) return;
  const cell_baker baker = baker_of(work.context);
  const record_of_phase_1 before = [&](std::uint32_t cell) {
    return required(work.file.records(), cell, work.plan.end_of_phase_1(cell));
  };
  stop_request stop;
  run(work, baker, work.tracker.cells_left() > 0 ? bake_phase::baking_cells : bake_phase::checking_neighbors,
      step_queue::both_phases(work.plan, work.tracker.have(), work.blocks), stop,
      [&](const cell_step& step, cell_set& set) {
        const bool is_check = step.to == cell_stage::finished && work.plan.end_of_phase_1(step.cell) != step.to;
        return is_check ? check(work, baker, before, step.cell, set, stop)
                        : step_of_phase_1(work, baker, step, set, stop);
      });
}

}  // namespace sightcell::bake
