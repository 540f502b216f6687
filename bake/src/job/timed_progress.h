#pragma once
// The progress tracker of a bake with a time budget: commits records, orders the turns of the cells and reports
// progress. Everything runs on the calling thread.
#include <cstdint>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "job/steps_in_work.h"
#include "sightcell/bake/progress.h"
#include "sightcell/base/time_budget.h"

namespace sightcell::bake {

class timed_progress {
 public:
  // last_target: the bound that every cell has to reach in the end. References must outlive the object.
  timed_progress(std::uint32_t polygon_count, std::span<const view_cell> cells, double last_target,
                 const time_budget& clock, const callbacks& events);

  // Takes a record of an earlier run.
  void resume(std::uint32_t cell, const cell_summary& record);
  // To be called before the turns to this target. open and close return false if no further turn may begin.
  bool open(double target);
  // Reports that a phase begins.
  void begin(bake_phase phase);
  // Commits the records of turns that have ended, also after a cancel, and reports progress.
  // records: empty if no turn has ended since the last report.
  // in_work: the other turns that have begun.
  bool close(std::span<const stage_record> records, std::span<const step_in_work> in_work, checkpoint& done);

  // Returns the cells with a bound above the target or without a bound, the largest first. Cells without a valid
  // viewpoint are left out.
  std::vector<std::uint32_t> above(double target) const;
  // Returns the cells that have a bound or no valid viewpoint, ascending.
  std::vector<std::uint32_t> known() const;
  std::uint32_t bounded() const;    // cells with a bound
  std::uint32_t unreached() const;  // cells without a bound that may have a valid viewpoint
  // Cells with a bound above the last target whose last turn spent its rays before the time was over.
  std::uint32_t out_of_rays() const;

  bool stopped() const { return stopped_; }
  std::uint32_t resumed() const { return resumed_; }

 private:
  struct cell_state {
    double bound = 1.0;  // 1: none yet
    std::uint64_t rays = 0, misses = 0, polygons = 0;
    bool stored = true, gave_up = false;
    bool bounded() const { return stored && bound < 1.0; }
  };
  template <typename Is>
  std::uint32_t count(Is is) const;
  void take(std::uint32_t cell, const cell_summary& record);
  progress now() const;
  bool report_progress(std::span<const step_in_work> in_work);
  void report_stopping(std::span<const step_in_work> in_work);

  const std::uint32_t polygon_count_;
  const double last_target_;
  const time_budget& clock_;
  const callbacks& events_;
  const std::span<const view_cell> boxes_;  // by cell
  std::vector<cell_state> cells_;
  bake_phase phase_ = bake_phase::estimating;
  double target_ = 1.0;
  std::uint32_t resumed_ = 0, turns_ = 0;
  const work_clock::time_point began_ = work_clock::now();
  bool stopped_ = false, canceled_ = false;  // canceled: stopped, and not by an exception
};

}  // namespace sightcell::bake
