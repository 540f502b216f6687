#pragma once
// A request to end work that is not finished, made by one thread and noticed by all that do the work.
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <utility>

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

  // For work on the thread that has to make the request itself: check() calls poll on it, at most once per pause.
  void poll_with(std::function<void()> poll, std::chrono::milliseconds pause) {
    poll_ = std::move(poll);
    pause_ = pause;
    polled_ = clock::now();
  }
  // Throws step_stopped if the request was made. Called from the thread that owns the work, every few milliseconds to
  // some tenths of a second.
  void check() {
    if (poll_ && !asked_ && clock::now() - polled_ >= pause_) {
      poll_();
      polled_ = clock::now();
    }
    if (asked_) throw step_stopped();
  }

 private:
  using clock = std::chrono::steady_clock;
  std::atomic<bool> asked_{false};
  std::function<void()> poll_;
  std::chrono::milliseconds pause_{0};
  clock::time_point polled_{};
};

}  // namespace sightcell::bake
