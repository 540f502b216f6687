#pragma once
// Commits the records of steps, counts them and reports progress. Everything runs on the calling thread.
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "job/cell_steps.h"
#include "sightcell/bake/progress.h"

namespace sightcell::bake {

class progress_tracker {
 public:
  // References must outlive the object.
  // cells: how many cells of the plan are to be baked.
  // last_phase: 1 or 2; nothing is left to do after it.
  progress_tracker(std::uint32_t polygon_count, const stage_plan& plan, std::uint32_t cells, const callbacks& events,
                   int last_phase = 2);

  // Takes a record of an earlier run. Before open().
  void resume(std::uint32_t cell, cell_stage stage, const cell_summary& record);
  // Reports the start. Before the first step. This, preparing and close return false if the caller canceled.
  bool open();
  // Reports progress of what the sampler does for all cells together. Before the first step.
  // share: the part that is done, 0 .. 1.
  bool preparing(double share);
  // Commits the records of steps that have ended, also after a cancel.
  // in_work: how many other steps have begun.
  bool close(std::span<const stage_record> records, std::size_t in_work, checkpoint& done);

  bool stopped() const { return stopped_; }
  std::uint32_t resumed() const { return resumed_; }      // cells of an earlier run that are through phase 1
  std::uint32_t not_empty() const { return not_empty_; }  // cells of this run with geometry inside
  std::uint32_t cells_total() const { return now_.cells_total; }
  std::uint32_t cells_left() const { return now_.cells_total - now_.cells_done; }
  double visible_percent() const { return now_.visible_percent; }
  double worst_bound() const { return now_.worst_bound; }
  const stage_table& have() const { return have_; }

 private:
  static double work_until(cell_stage stage);
  void count(std::uint32_t cell, cell_stage stage, const cell_summary& record);
  void forget_first_rounds(std::span<const stage_record> records, std::vector<std::uint32_t>& forget) const;
  bool report_progress(std::size_t in_work);

  std::uint32_t polygon_count_;
  const stage_plan& plan_;
  const callbacks& events_;
  int last_phase_;
  stage_table have_;
  std::vector<bool> counted_;         // through phase 1
  std::vector<std::uint32_t> sizes_;  // of the cell sets, as counted so far
  std::vector<double> work_of_;       // by cell: the part that is done, 0 .. 1
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  progress now_;                               // over the cells of this run and of earlier runs
  double work_done_ = 0.0, fresh_work_ = 0.0;  // in cells
  std::uint64_t rays_ = 0, misses_ = 0;
  double visible_ = 0.0;
  std::uint32_t stored_ = 0, resumed_ = 0, not_empty_ = 0;
  bool stopped_ = false;
};

}  // namespace sightcell::bake
