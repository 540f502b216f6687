#include "phase_times.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "progress_text.h"
#include "sightcell/base/process_time.h"

namespace sightcell::cli {

void phase_times::begin(bake::bake_phase phase) {
  end();
  const auto found =
      std::find_if(phases_.begin(), phases_.end(), [&](const timed_phase& one) { return one.phase == phase; });
  current_ = static_cast<std::size_t>(found - phases_.begin());
  if (found == phases_.end()) phases_.push_back({phase});
  began_ = std::chrono::steady_clock::now();
  cpu_at_begin_ = bake::process_cpu_seconds();
  running_ = true;
}

void phase_times::end() {
  if (!running_) return;
  phases_[current_].seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  phases_[current_].cpu_seconds += bake::process_cpu_seconds() - cpu_at_begin_;
  running_ = false;
}

nlohmann::ordered_json phase_times::json() const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const timed_phase& one : phases_)
    list.push_back({{"phase", phase_name(one.phase)}, {"seconds", one.seconds}, {"cpu_seconds", one.cpu_seconds}});
  return list;
}

}  // namespace sightcell::cli
