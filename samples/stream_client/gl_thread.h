#pragma once
// OpenGL on a thread of its own, so that requests do not wait for pictures.
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "sightcell/picture/gl_context.h"

namespace stream_client {

class gl_thread {
 public:
  // Creates the context, which is current on the thread. Fails with gl.*.
  gl_thread();

  // Waits for all work.
  ~gl_thread();
  gl_thread(const gl_thread&) = delete;
  gl_thread& operator=(const gl_thread&) = delete;

  // For use in work.
  const sightcell::picture::gl_context& context() const { return *context_; }

  // Adds work. It begins in the order of the calls, also after other work has failed.
  // Fails with what has failed in the meantime.
  void post(std::function<void()> work);

  // As `post`, and waits for it.
  void run(std::function<void()> work);

 private:
  void loop();
  std::uint64_t add(std::function<void()> work);
  void rethrow();

  std::unique_ptr<sightcell::picture::gl_context> context_;
  std::mutex mutex_;  // of the following
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  std::uint64_t added_ = 0, done_ = 0;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace stream_client
