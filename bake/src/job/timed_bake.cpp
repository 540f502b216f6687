#include "job/timed_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "file/importance_section.h"
#include "file/pvs_output.h"
#include "file/residency_section.h"
#include "input/first_target.h"
#include "job/cell_bake.h"
#include "job/cell_workers.h"
#include "job/phases.h"
#include "job/timed_progress.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr double next_target = 0.25;  // times the target before
// Limits of a turn. A cell that needs many times the rays of others to reach a target continues in its next turn.
constexpr double rays_times_target = 4e3, fewest_rays_of_turn = 2e6, most_rays_of_turn = 1e8;
constexpr double share_between_files = 0.1, seconds_between_files = 60.0;
constexpr double work_to_writing = 10.0;  // least ratio of working time to writing time
constexpr double writing_grows = 1.5;     // most, from one file to the next

std::vector<double> targets_of(const settings& how) {
  const double last = how.max_pixel_error;
  std::vector<double> targets{first_target(how)};
  while (targets.back() > last) {
    const double next = targets.back() * next_target;
    targets.push_back(next < 2.0 * last ? last : next);
  }
  return targets;
}

class timed_bake {
 public:
  explicit timed_bake(const timed_work& work);

  void resume();
  void run();
  void end(summary& sum);

 private:
  const settings& how() const { return work_.context.how; }
  std::optional<cell_record> load(std::uint32_t cell) const;
  std::vector<cell_record> neighbors_of_now(std::uint32_t cell, const cell_record& own) const;
  bool take_turns(bake_phase phase, const std::vector<std::uint32_t>& cells, const take_step& take);
  void write_if_due();
  file_completion last_completion() const;
  void write(const callbacks& events, summary& sum, const file_completion& complete = {});

  const timed_work& work_;
  const cell_baker baker_;
  const pvs_frame frame_;
  timed_progress progress_;
  const double pause_;  // seconds between files
  double next_file_;    // seconds of the budget when the next file is due
  stop_request stop_;
};

timed_bake::timed_bake(const timed_work& work)
    : work_(work),
      baker_(baker_of(work.context)),
      frame_(work.context.frame()),
      progress_(work.context.s.polygon_count, work.context.cells->list.cells, work.context.how.max_pixel_error,
                work.clock, work.events),
      pause_(std::min(share_between_files * work.context.how.time_budget, seconds_between_files)),
      next_file_(pause_) {}

void timed_bake::resume() {
  const std::uint32_t damaged =
      work_.file.records().survey([&](std::uint32_t cell, cell_stage stage, const cell_summary& record) {
        if (stage == cell_stage::bounded) progress_.resume(cell, record);
      });
  report_resume(damaged, progress_.resumed(), static_cast<std::uint32_t>(frame_.cells.size()), work_.events);
}

// Returns the last record of the cell. A turn that had no time for a hemicube counts as none.
std::optional<cell_record> timed_bake::load(std::uint32_t cell) const {
  std::optional<cell_record> record = work_.file.records().load(cell, cell_stage::bounded);
  if (record && record->stored && record->samples == 0) record.reset();
  return record;
}

// Returns the current records of the neighbors; empty ones for cells that had no turn yet.
std::vector<cell_record> timed_bake::neighbors_of_now(std::uint32_t cell, const cell_record& own) const {
  return neighbors_of(own, work_.plan.blocks().neighbors_of(cell),
                      [&](std::uint32_t other) { return load(other).value_or(cell_record()); });
}

// Returns false if no further turn may begin.
bool timed_bake::take_turns(bake_phase phase, const std::vector<std::uint32_t>& cells, const take_step& take) {
  if (cells.empty()) return true;
  progress_.begin(phase);
  std::vector<cell_step> steps;
  for (const std::uint32_t cell : cells) steps.push_back({cell, cell_stage::bounded});
  step_queue queue = step_queue::listed(work_.plan, steps);
  bool proceed = true;
  take_steps(
      queue, [&] { return baker_.make_set(); }, take, workers_for(work_.context, baker_, work_.arena, stop_),
      [&](std::span<const stage_record> ended, std::span<const step_in_work> in_work) {
        proceed = progress_.close(ended, in_work, work_.file.records()) && proceed;
        work_.file.copy_if_due();
        if (proceed) write_if_due();
        return proceed;
      });
  return proceed;
}

void timed_bake::run() {
  const std::vector<view_cell>& cells = work_.context.cells->list.cells;
  for (const double target : targets_of(how())) {
    if (!progress_.open(target) || work_.clock.over()) return;
    const auto max_rays =
        static_cast<std::uint64_t>(std::clamp(rays_times_target / target, fewest_rays_of_turn, most_rays_of_turn));
    const take_step take = [&](const cell_step& step, cell_set& set) {
      const time_limit limit = work_.clock.limit(&stop_);
      const std::optional<cell_record> before = load(step.cell);
      std::vector<cell_record> neighbors;
      if (before) neighbors = neighbors_of_now(step.cell, *before);
      return baker_.improve(cells[step.cell], before ? &*before : nullptr, neighbors, {target, max_rays, &limit}, set);
    };
    if (!take_turns(bake_phase::baking_cells, progress_.above(target), take)) return;
  }
  // The last neighbor check. It finds polygons that no bound needs.
  (void)take_turns(bake_phase::checking_neighbors, progress_.known(), [&](const cell_step& step, cell_set& set) {
    const time_limit limit = work_.clock.limit(&stop_);
    const cell_record before = required(work_.file.records(), step.cell, cell_stage::bounded);
    if (limit.reached()) return before;
    return baker_.check(cells[step.cell], before, neighbors_of_now(step.cell, before), set, nullptr, &limit);
  });
}

void timed_bake::write_if_due() {
  if (work_.clock.spent() < next_file_ || progress_.bounded() == 0) return;
  summary unread;
  write({}, unread);
}

void timed_bake::write(const callbacks& events, summary& sum, const file_completion& complete) {
  const double began = work_.clock.spent();
  const std::vector<std::uint32_t> cells = progress_.known();
  pvs_frame frame = frame_;
  frame.cells.clear();
  for (const std::uint32_t cell : cells) frame.cells.push_back(frame_.cells[cell]);
  write_pvs(
      frame,
      [&](std::uint32_t i) {
        return baker_.finished(work_.context.cells->list.cells[cells[i]],
                               required(work_.file.records(), cells[i], cell_stage::bounded));
      },
      work_.output, events, sum, complete);
  const double took = work_.clock.spent() - began;
  work_.clock.keep_back(writing_grows * took);
  next_file_ = work_.clock.spent() + std::max(pause_, work_to_writing * took);
}

// Only the last file has texture residency and importance, because measuring the latter may take as long as a turn. The
// file of a canceled bake has neither, because the caller wants to end.
file_completion timed_bake::last_completion() const {
  if (!how().file.importance && !how().file.residency) return {};
  return [this](std::vector<std::byte>& file) {
    const file_completion levels =
        residency_of(how(), work_.context.s, work_.context.traced->rays, work_.output, work_.events);
    if (levels && (progress_.stopped() || !levels(file)) && work_.events.on_message)
      work_.events.on_message(severity::warning,
                              "the file has no texture residency, which was not waited for; sightcell recode FILE "
                              "--residency SCENE adds it");
    if (!how().file.importance) return true;
    const file_completion measure = importance_of(how(), work_.context.traced->rays, work_.output, work_.events);
    if ((progress_.stopped() || !measure(file)) && work_.events.on_message)
      work_.events.on_message(
          severity::warning,
          "the file has no importance, which was not waited for; sightcell recode FILE --importance "
          "SCENE adds it");
    return true;
  };
}

void timed_bake::end(summary& sum) {
  sum.cells_resumed = progress_.resumed();
  sum.cells_unreached = progress_.unreached();
  const bool nothing = progress_.bounded() == 0 && progress_.unreached() > 0;
  if (!progress_.stopped() && nothing)
    throw error(error_kind::failed, "bake.time-budget", frame_.scene_name,
                fmt::format("no cell has come to a bound in {:g} s", how().time_budget),
                "give a larger --time-budget: the bake goes on with what was found");
  if (!nothing) write(progress_.stopped() ? callbacks() : work_.events, sum, last_completion());
  if (progress_.stopped()) {
    sum.result = outcome::cancelled;
    work_.file.copy();
    return;
  }
  sum.cells_out_of_time = sum.cells_over_bound - std::min(sum.cells_over_bound, progress_.out_of_rays());
  if (sum.cells_unreached > 0) {
    sum.result = outcome::bound_not_met;
    if (work_.events.on_message)
      work_.events.on_message(
          severity::warning,
          fmt::format("{} of {} cells have no bound yet and are left out; a camera there is outside all cells",
                      sum.cells_unreached, frame_.cells.size()));
  }
  work_.file.remove();
}

}  // namespace

void bake_in_time(const timed_work& work, summary& sum) {
  timed_bake one(work);
  one.resume();
  keeping(work.file, [&] {
    one.run();
    one.end(sum);
  });
}

}  // namespace sightcell::bake
