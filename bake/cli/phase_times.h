#pragma once
// How long each phase of a bake takes.
#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "sightcell/bake/progress.h"

namespace sightcell::cli {

class phase_times {
 public:
  // A phase begins, and the one before it ends.
  void begin(bake::bake_phase phase);
  // The last phase ends.
  void end();

  // Returns a list of {"phase", "seconds", "cpu_seconds"}: wall-clock time, and CPU time of the process. A phase that
  // began several times has one entry.
  nlohmann::ordered_json json() const;

 private:
  struct timed_phase {
    bake::bake_phase phase;
    double seconds = 0.0, cpu_seconds = 0.0;
  };

  std::vector<timed_phase> phases_;  // in the order in which they first began
  std::size_t current_ = 0;
  bool running_ = false;
  std::chrono::steady_clock::time_point began_;
  double cpu_at_begin_ = 0.0;
};

}  // namespace sightcell::cli
