#pragma once
// A request to end work that is not finished, made by one thread and noticed by all that do the work.
#include <atomic>
#include <exception>

namespace sightcell::bake {

// Thrown where a step ends because of a request. What the step has computed so far is dropped.
struct step_stopped : std::exception {
  const char* what() const noexcept override { return "stopped on request"; }
};

class stop_request {
 public:
  // Makes the request; it stays.
  void ask() { asked_ = true; }
  // Returns whether it was made. May be called from any thread.
  bool asked() const { return asked_; }

  // Throws step_stopped if the request was made.
  void check() const {
    if (asked_) throw step_stopped();
  }

 private:
  std::atomic<bool> asked_{false};
};

}  // namespace sightcell::bake
