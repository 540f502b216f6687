#include "gl_thread.h"

#include <utility>

namespace stream_client {

gl_thread::gl_thread() : thread_([this] { loop(); }) {
  try {
    run([this] { context_ = std::make_unique<sightcell::picture::gl_context>(); });
  } catch (...) {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
    throw;
  }
}

gl_thread::~gl_thread() {
  add([this] { context_.reset(); });
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void gl_thread::post(std::function<void()> work) {
  add(std::move(work));
  rethrow();
}

void gl_thread::run(std::function<void()> work) {
  const std::uint64_t number = add(std::move(work));
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return done_ >= number; });
  }
  rethrow();
}

std::uint64_t gl_thread::add(std::function<void()> work) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
    number = ++added_;
  }
  changed_.notify_all();
  return number;
}

void gl_thread::rethrow() {
  std::exception_ptr failure;
  {
    const std::lock_guard lock(mutex_);
    failure = std::exchange(failure_, nullptr);
  }
  if (failure) std::rethrow_exception(failure);
}

void gl_thread::loop() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::function<void()> work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    std::exception_ptr failure;
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
    work = nullptr;  // what it holds ends outside the lock
    lock.lock();
    if (!failure_) failure_ = failure;
    ++done_;
    changed_.notify_all();
  }
}

}  // namespace stream_client
