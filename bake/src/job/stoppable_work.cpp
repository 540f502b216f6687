#include "job/stoppable_work.h"

#include <chrono>
#include <exception>
#include <future>

namespace sightcell::bake {

void run_stoppable(tbb::task_arena& arena, const std::function<void()>& work, const std::function<bool()>& report,
                   stop_request& stop) {
  constexpr std::chrono::milliseconds pause{200};
  std::future<void> working = std::async(std::launch::async, [&] { arena.execute(work); });
  std::exception_ptr failed;
  while (working.wait_for(pause) == std::future_status::timeout) {
    if (stop.asked()) continue;
    try {
      if (!report()) stop.ask();
    } catch (...) {
      failed = std::current_exception();
      stop.ask();
    }
  }
  try {
    working.get();
  } catch (...) {
    if (!stop.asked()) throw;  // else it is what the stop did to a part of the work
  }
  if (failed) std::rethrow_exception(failed);
  stop.check();
}

}  // namespace sightcell::bake
