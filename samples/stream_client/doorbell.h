#pragma once
// Wakes the thread that schedules when another thread has something for it.
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace stream_client {

using clock = std::chrono::steady_clock;

class doorbell {
 public:
  void ring() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      rung_ = true;
    }
    changed_.notify_one();
  }

  // Returns when it was rung since the last wait, or at this time.
  void wait_until(clock::time_point end) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_until(lock, end, [this] { return rung_; });
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool rung_ = false;
};

}  // namespace stream_client
