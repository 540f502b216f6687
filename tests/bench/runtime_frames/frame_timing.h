#pragma once
// How frames are timed: each figure is the median of passes. What takes less than a microsecond is timed thousands of
// calls at a time by the processor time of the program, which does not count others; the rest by the steady clock,
// where a call that others interrupt is outvoted.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <vector>

namespace sightcell::bench {

struct frame_timing {
  unsigned repeat = 101;
  std::uint32_t most_cells = 1'000'000;
  std::uint32_t lookups = 1'000'000;  // of each pass
  std::size_t walk_bytes = std::size_t{64} << 20;
};

// Nanoseconds of one call of work.
template <class Work>
double time_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return static_cast<double>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count());
}

// Nanoseconds of processor time of work that takes milliseconds; the program has one thread.
template <class Work>
double cpu_time_of(const Work& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) * (1e9 / CLOCKS_PER_SEC);
}

inline double median_of(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

}  // namespace sightcell::bench
