#pragma once
// --seconds-per-cell: how long a cell has been sampled. Only where a limit is set does time decide what is found.
#include <chrono>

#include "process_time.h"

namespace sightcell::bake {

class time_limit {
 public:
  // Begins now. seconds: 0, no limit. on_this_thread: CPU time of the calling thread counts, which other work on the
  // machine does not shorten; else the time on the wall, for work that a device does.
  time_limit(double seconds, bool on_this_thread) : seconds_(seconds), on_this_thread_(on_this_thread) {
    if (seconds_ > 0.0) began_ = now();
  }
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
