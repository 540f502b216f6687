#pragma once
// --time-budget: the clock of a whole bake. Calls may come from any thread.
#include <algorithm>
#include <atomic>
#include <chrono>

#include "sightcell/bake/settings.h"
#include "sightcell/base/time_limit.h"

namespace sightcell::bake {

// What every cell is brought to before any is brought further: with a budget an error that is soon met.
inline double first_target(const settings& how) {
  return how.time_budget > 0.0 ? std::max(1e-2, how.max_pixel_error) : how.max_pixel_error;
}

class time_budget {
 public:
  // Begins now. gone: seconds that were spent before.
  time_budget(double seconds, double gone) : seconds_(seconds), gone_(gone) {}

  double spent() const { return gone_ + std::chrono::duration<double>(clock::now() - began_).count(); }
  // Until work has to end so that what is kept back is left.
  double left() const { return seconds_ - kept_back_ - spent(); }
  bool over() const { return left() <= 0.0; }
  // For a piece of work that begins now.
  time_limit limit() const { return {std::max(left(), 1e-9), false}; }

  // Seconds for what comes after the last piece of work.
  void keep_back(double seconds) { kept_back_ = seconds; }

 private:
  using clock = std::chrono::steady_clock;

  const double seconds_, gone_;
  const clock::time_point began_ = clock::now();
  std::atomic<double> kept_back_{0.0};
};

}  // namespace sightcell::bake
