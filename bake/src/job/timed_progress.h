#pragma once
// What a bake with a time budget knows of its cells: commits records, says whose turn is next, and tells of it all, on
// the calling thread.
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "sightcell/bake/progress.h"
#include "sightcell/base/time_budget.h"

namespace sightcell::bake {

class timed_progress {
 public:
  // last_target: what every cell is to reach in the end. References must outlive the object.
  timed_progress(std::uint32_t polygon_count, std::size_t cells, double last_target, const time_budget& clock,
                 const callbacks& tell);

  // A record of an earlier run.
  void resume(std::uint32_t cell, const cell_summary& record);
  // Turns to this bound begin. This and close answer false when no further one may.
  bool open(double target);
  // Turns that have ended. Steps that end after the user has had enough are still committed.
  bool close(std::span<const stage_record> records, checkpoint& done);

  // Whose bound is above the target or not known, the largest first; none that has no free place.
  std::vector<std::uint32_t> above(double target) const;
  // Whose bound is known, or that have no free place: in the order of their numbers.
  std::vector<std::uint32_t> known() const;
  std::uint32_t bounded() const;    // how many bounds are known
  std::uint32_t unreached() const;  // how many cells have neither
  // Bounds above the last target though the last turn had time: its rays were spent.
  std::uint32_t out_of_rays() const;

  bool stopped() const { return stopped_; }
  std::uint32_t resumed() const { return resumed_; }

 private:
  struct cell_state {
    double bound = 1.0;  // 1: nothing is known
    std::uint64_t rays = 0, misses = 0, polygons = 0;
    bool stored = true, gave_up = false;
    bool bounded() const { return stored && bound < 1.0; }
  };
  template <typename Is>
  std::uint32_t count(Is is) const;
  void take(std::uint32_t cell, const cell_summary& record);
  bool tell_progress();

  const std::uint32_t polygon_count_;
  const double last_target_;
  const time_budget& clock_;
  const callbacks& tell_;
  std::vector<cell_state> cells_;
  double target_ = 1.0;
  std::uint32_t resumed_ = 0, turns_ = 0;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  bool stopped_ = false;
};

}  // namespace sightcell::bake
