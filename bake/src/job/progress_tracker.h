#pragma once
// What has come of the cells so far: commits records, counts them and tells of them, all on the calling thread.
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
  // cells: how many are to be baked, of those that plan is about. References must outlive the progress_tracker. phase:
  // after which nothing is left to do.
  progress_tracker(std::uint32_t polygon_count, const stage_plan& plan, std::uint32_t cells, const callbacks& tell,
                   int last_phase = 2);

  // A record of an earlier run; before open().
  void resume(std::uint32_t cell, cell_stage stage, const cell_summary& record);
  // Before the first step. This and close answer false when the user has had enough.
  bool open();
  // Before the first step too: so much of what the sampler does for all cells is done, 0 to 1.
  bool preparing(double share);
  // Steps that end after the user has had enough are still committed.
  bool close(std::span<const stage_record> records, std::size_t in_work, checkpoint& done);

  bool stopped() const { return stopped_; }
  std::uint32_t resumed() const { return resumed_; }      // cells that were through phase 1
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
  bool tell_progress(std::size_t in_work);

  std::uint32_t polygon_count_;
  const stage_plan& plan_;
  const callbacks& tell_;
  int last_phase_;
  stage_table have_;
  std::vector<bool> counted_;         // through phase 1
  std::vector<std::uint32_t> sizes_;  // of the sets, as counted
  std::vector<double> work_of_;       // of each cell: the part that is done
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  progress now_;                               // over the cells of this run and those resumed
  double work_done_ = 0.0, fresh_work_ = 0.0;  // in cells
  std::uint64_t rays_ = 0, misses_ = 0;
  double visible_ = 0.0;
  std::uint32_t stored_ = 0, resumed_ = 0, not_empty_ = 0;
  bool stopped_ = false;
};

}  // namespace sightcell::bake
