#include "bound/valid_count.h"

#include <algorithm>
#include <cmath>

namespace sightcell::bake {
namespace {

double log_choose(std::uint64_t n, std::uint64_t k) {
  const auto log_factorial = [](std::uint64_t i) { return std::lgamma(static_cast<double>(i) + 1.0); };
  return log_factorial(n) - log_factorial(k) - log_factorial(n - k);
}

// P(at least `free` of the tested are free) where `all_free` of all places are, or a half where it is no less than
// that. Terms are summed upwards from the first, each from the one before it; they begin above the mean, so they only
// fall.
double at_least(std::uint64_t places, std::uint64_t all_free, std::uint64_t tested, std::uint64_t free) {
  if (all_free < free) return 0.0;
  const std::uint64_t walled = places - all_free;
  // So many of the tested are free whatever happens.
  const std::uint64_t first = std::max(free, tested > walled ? tested - walled : 0);
  if (first > free) return 1.0;
  // A median is the mean rounded down, or above that (Siegel 2001). Terms that rise would leave a double.
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
  // More free places make more free ones among the tested: the lowest count that is not too unlikely.
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
