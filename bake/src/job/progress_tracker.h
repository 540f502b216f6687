#pragma once
// Commits the records of steps, counts them and reports progress. Everything runs on the calling thread.
#include <cstdint>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "job/cell_steps.h"
#include "job/steps_in_work.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/progress.h"

namespace sightcell::bake {

// What is tracked.
struct tracked_cells {
  std::uint32_t polygon_count = 0;   // of the scene
  std::span<const view_cell> cells;  // all cells of the plan
  std::uint32_t total = 0;           // how many of them are to be baked
  int last_phase = 2;                // 1 or 2; nothing is left to do after it
  time_source now = work_clock::now;
};

class progress_tracker {
 public:
  // References must outlive the object.
  progress_tracker(tracked_cells tracked, const stage_plan& plan, const callbacks& events);

  // Takes a record of an earlier run. Before open().
  void resume(std::uint32_t cell, cell_stage stage, const cell_summary& record);
  // Takes the estimated seconds of all cells that are left: the time left until the first step has ended.
  void expect(double seconds) { expected_ = seconds; }
  // Reports the start. Before the first step. This, preparing and close return false if the caller canceled.
  bool open();
  // Reports that a phase begins.
  void begin(bake_phase phase);
  // Reports progress of what the sampler does for all cells together. Before the first step.
  // share: the part that is done, 0 .. 1.
  bool preparing(double share);
  // Commits the records of steps that have ended, also after a cancel, and reports progress.
  // records: empty if no step has ended since the last report.
  // in_work: the other steps that have begun.
  bool close(std::span<const stage_record> records, std::span<const step_in_work> in_work, checkpoint& done);

  bool stopped() const { return stopped_; }
  std::uint32_t resumed() const { return resumed_; }      // cells of an earlier run that are through phase 1
  std::uint32_t not_empty() const { return not_empty_; }  // cells of this run with geometry inside
  std::uint32_t cells_total() const { return now_.cells_total; }
  std::uint32_t cells_left() const { return now_.cells_total - now_.cells_done; }
  double visible_percent() const { return now_.visible_percent; }
  double worst_bound() const { return now_.worst_bound; }
  const stage_table& have() const { return have_; }
  cell_times times() const;  // of the cells that began and ended since the start

 private:
  static double work_until(cell_stage stage);
  void count(std::uint32_t cell, cell_stage stage, const cell_summary& record);
  void forget_first_rounds(std::span<const stage_record> records, std::vector<std::uint32_t>& forget) const;
  void estimate_time(std::size_t in_work);
  bool report_progress(std::span<const step_in_work> in_work);
  void report_stopping(std::span<const step_in_work> in_work);

  const tracked_cells tracked_;
  const stage_plan& plan_;
  const callbacks& events_;
  stage_table have_;
  std::vector<bool> counted_;         // through phase 1
  std::vector<std::uint32_t> sizes_;  // of the cell sets, as counted so far
  std::vector<double> work_of_;       // by cell: the part that is done, 0 .. 1
  std::vector<float> seconds_of_;  // by cell: of the steps of this run; negative for one with steps of an earlier run
  std::vector<bounded_cell> bounded_;  // since the last report
  work_clock::time_point began_;
  double expected_ = 0.0;                      // seconds for the cells that were left at the start
  progress now_;                               // over the cells of this run and of earlier runs
  double work_done_ = 0.0, fresh_work_ = 0.0;  // in cells
  std::uint64_t rays_ = 0, misses_ = 0;
  double visible_ = 0.0;
  std::uint32_t stored_ = 0, resumed_ = 0, not_empty_ = 0;
  bool stopped_ = false, canceled_ = false;  // canceled: stopped, and not by an exception
};

}  // namespace sightcell::bake
