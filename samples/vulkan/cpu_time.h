#pragma once
// CPU time so far, in milliseconds.
#include <ctime>

namespace vulkan_host {

inline double cpu_milliseconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

inline double thread_milliseconds() {
  return cpu_milliseconds(CLOCK_THREAD_CPUTIME_ID);
}
inline double process_milliseconds() {
  return cpu_milliseconds(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace vulkan_host
