#pragma once
// CPU time of the calling thread so far, in milliseconds.
#include <ctime>

namespace gpu_driven {

inline double thread_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace gpu_driven
