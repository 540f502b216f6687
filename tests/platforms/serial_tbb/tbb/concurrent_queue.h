#pragma once
// Replaces oneTBB where the platform has no such library. For one thread.
#include <deque>
#include <utility>

namespace tbb {

template <class T>
class concurrent_queue {
 public:
  void push(T value) { values_.push_back(std::move(value)); }
  bool try_pop(T& value) {
    if (values_.empty()) return false;
    value = std::move(values_.front());
    values_.pop_front();
    return true;
  }

 private:
  std::deque<T> values_;
};

}  // namespace tbb
