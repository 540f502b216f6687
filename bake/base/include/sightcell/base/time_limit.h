#pragma once
// A limit of the time that is spent on one cell: --seconds-per-cell, or a turn of --time-budget. Results depend on time
// only where such a limit is set.
#include <chrono>

#include "sightcell/base/process_time.h"

namespace sightcell::bake {

class time_limit {
 public:
  // Starts the limit.
  // seconds: 0 for no limit.
  // on_this_thread: true counts the CPU time of the calling thread, which other work on the machine does not change.
  //   False counts wall-clock time, for work that a device does.
  time_limit(double seconds, bool on_this_thread) : seconds_(seconds), on_this_thread_(on_this_thread) {
    if (seconds_ > 0.0) began_ = now();
  }

  // Returns whether the limit is reached. To be called on the thread that made it.
  bool reached() const { return seconds_ > 0.0 && now() - began_ >= seconds_; }

 private:
  double now() const {
    if (on_this_thread_) return thread_cpu_seconds();
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  double seconds_;
  bool on_this_thread_;
  double began_ = 0.0;
};

}  // namespace sightcell::bake
