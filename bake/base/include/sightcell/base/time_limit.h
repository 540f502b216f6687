#pragma once
// The limits of a piece of work on one cell: its time (--seconds-per-cell, or a turn of --time-budget), and a request
// to stop. Results depend on time only where a limit of time is set.
#include <algorithm>
#include <chrono>
#include <limits>

#include "sightcell/base/process_time.h"
#include "sightcell/base/stop_request.h"

namespace sightcell::bake {

class time_limit {
 public:
  // Starts the limit.
  // seconds: 0 for no limit.
  // on_this_thread: true counts the CPU time of the calling thread, which other work on the machine does not change.
  //   False counts wall-clock time, for work that a device does.
  // stop: null for none. Must outlive the limit.
  time_limit(double seconds, bool on_this_thread, stop_request* stop = nullptr)
      : seconds_(seconds), on_this_thread_(on_this_thread), stop_(stop) {
    if (has_time()) began_ = now();
  }

  // Returns whether the time is over. To be called on the thread that made the limit, every few milliseconds to some
  // tenths of a second.
  // Throws step_stopped if a stop was requested.
  bool reached() const {
    if (stop_) stop_->check();
    return has_time() && spent() >= seconds_;
  }
  // Returns whether a stop was requested, for loops that other threads run. May be called from any thread.
  bool stopped() const { return stop_ && stop_->asked(); }

  // Returns whether there is a limit of time.
  bool has_time() const { return seconds_ > 0.0; }
  // Returns the seconds since the start, and those that are left; without a limit of time 0 and infinity.
  double spent() const { return has_time() ? now() - began_ : 0.0; }
  double left() const {
    return has_time() ? std::max(seconds_ - spent(), 0.0) : std::numeric_limits<double>::infinity();
  }
  // Returns the limit of a part of the work that begins now: a share of the time that is left, 0 .. 1. It ends at once
  // if none is left.
  time_limit part(double share) const {
    return {has_time() ? std::max(share * left(), least_seconds) : 0.0, on_this_thread_, stop_};
  }

 private:
  static constexpr double least_seconds = 1e-9;

  double now() const {
    if (on_this_thread_) return thread_cpu_seconds();
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  double seconds_;
  bool on_this_thread_;
  stop_request* stop_;
  double began_ = 0.0;
};

inline const time_limit no_limit(0.0, true);

}  // namespace sightcell::bake
