#pragma once
// A spin lock for a few dozen instructions. std::mutex is missing in some C++ libraries that engines build with.
#include <atomic>

namespace sightcell::runtime {

class latch {
 public:
  void lock() noexcept {
    while (taken_.test_and_set(std::memory_order_acquire)) {
    }
  }
  void unlock() noexcept { taken_.clear(std::memory_order_release); }

 private:
  std::atomic_flag taken_;
};

class latch_guard {
 public:
  explicit latch_guard(latch& l) noexcept : latch_(l) { latch_.lock(); }
  ~latch_guard() { latch_.unlock(); }
  latch_guard(const latch_guard&) = delete;
  latch_guard& operator=(const latch_guard&) = delete;

 private:
  latch& latch_;
};

}  // namespace sightcell::runtime
