#pragma once
// The wall-clock budget of a whole bake (--time-budget).
#include <algorithm>
#include <atomic>
#include <chrono>

#include "sightcell/base/time_limit.h"

namespace sightcell::bake {

// Wall-clock seconds that a bake may take. All functions may be called from any thread.
class time_budget {
 public:
  // Starts the clock.
  // gone: seconds that earlier runs of the same bake took.
  time_budget(double seconds, double gone) : seconds_(seconds), gone_(gone) {}

  // Returns the seconds since the start, with those of earlier runs.
  double spent() const { return gone_ + std::chrono::duration<double>(clock::now() - began_).count(); }
  // Returns the seconds that remain for cells. Negative if the budget is exceeded.
  double left() const { return seconds_ - kept_back_ - spent(); }
  bool over() const { return left() <= 0.0; }
  // Returns the limit of a piece of work that starts now.
  time_limit limit(stop_request* stop = nullptr) const { return {std::max(left(), 1e-9), false, stop}; }

  // Reserves seconds for what follows the last cell, such as writing the file.
  void keep_back(double seconds) { kept_back_ = seconds; }

 private:
  using clock = std::chrono::steady_clock;

  const double seconds_, gone_;
  const clock::time_point began_ = clock::now();
  std::atomic<double> kept_back_{0.0};
};

}  // namespace sightcell::bake
