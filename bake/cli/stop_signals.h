#pragma once
// How a bake is stopped from outside. The first SIGINT, SIGTERM or SIGHUP (the terminal is gone) asks for an orderly
// end, the second of any of them ends at once: finished cells are on the disk either way. A signal that the caller has
// ignored, as nohup does with SIGHUP, stays ignored.
#include <csignal>
#include <utility>
#include <vector>

namespace sightcell::cli {

class stop_signals {
 public:
  stop_signals();  // one at a time
  ~stop_signals();
  stop_signals(const stop_signals&) = delete;
  stop_signals& operator=(const stop_signals&) = delete;

  bool asked() const;

 private:
  void set(int signal);

  std::vector<std::pair<int, struct sigaction>> before_;
};

}  // namespace sightcell::cli
