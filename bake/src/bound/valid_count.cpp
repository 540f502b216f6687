#include "bound/valid_count.h"

#include <algorithm>
#include <cmath>

namespace sightcell::bake {
namespace {

double log_choose(std::uint64_t n, std::uint64_t k) {
  const auto log_factorial = [](std::uint64_t i) { return std::lgamma(static_cast<double>(i) + 1.0); };
  return log_factorial(n) - log_factorial(k) - log_factorial(n - k);
}

// Returns P(at least `free` of the tested viewpoints are valid) if `all_free` of all viewpoints are; 0.5 stands for any
// value of at least that. Terms are summed upward from the first, each from the one before. They begin above the mean,
// so they only decrease.
double at_least(std::uint64_t places, std::uint64_t all_free, std::uint64_t tested, std::uint64_t free) {
  if (all_free < free) return 0.0;
  const std::uint64_t walled = places - all_free;
  // At least `first` of the tested viewpoints are valid in any case.
  const std::uint64_t first = std::max(free, tested > walled ? tested - walled : 0);
  if (first > free) return 1.0;
  // The median is at least the mean rounded down (Siegel 2001), so the probability is at least a half here. Terms that
  // increase would overflow a double.
  const double mean = static_cast<double>(tested) * static_cast<double>(all_free) / static_cast<double>(places);
  if (static_cast<double>(first) <= std::floor(mean)) return 0.5;
  const std::uint64_t last = std::min(tested, all_free);
  double sum = 1.0, term = 1.0;
  for (std::uint64_t x = first; x < last; ++x) {
    term *= static_cast<double>(all_free - x) / static_cast<double>(x + 1) * static_cast<double>(tested - x) /
            static_cast<double>(walled + x + 1 - tested);
    sum += term;
    if (term < sum * 1e-16) break;
  }
  return std::exp(log_choose(all_free, first) + log_choose(walled, tested - first) - log_choose(places, tested)) * sum;
}

}  // namespace

std::uint64_t valid_at_least(std::uint64_t places, std::uint64_t tested, std::uint64_t free, double risk) {
  // The probability grows with the number of valid viewpoints. The result is the lowest number whose probability
  // exceeds the risk.
  std::uint64_t low = free, high = places - (tested - free);
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (at_least(places, middle, tested, free) > risk)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace sightcell::bake
