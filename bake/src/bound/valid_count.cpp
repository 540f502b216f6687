#include "bound/valid_count.h"

#include <algorithm>
#include <cmath>

namespace sightcell::bake {
namespace {

double log_choose(std::uint64_t n, std::uint64_t k) {
  const auto log_factorial = [](std::uint64_t i) { return std::lgamma(static_cast<double>(i) + 1.0); };
  return log_factorial(n) - log_factorial(k) - log_factorial(n - k);
}

// Returns P(at least `valid` of the tested viewpoints are valid) if `all_valid` of all viewpoints are; 0.5 stands for
// any value of at least that. Terms are summed upward from the first, each from the one before. They begin above the
// mean, so they only decrease.
double at_least(std::uint64_t viewpoints, std::uint64_t all_valid, std::uint64_t tested, std::uint64_t valid) {
  if (all_valid < valid) return 0.0;
  const std::uint64_t invalid = viewpoints - all_valid;
  // At least `first` of the tested viewpoints are valid in any case.
  const std::uint64_t first = std::max(valid, tested > invalid ? tested - invalid : 0);
  if (first > valid) return 1.0;
  // The median is at least the mean rounded down (Siegel 2001), so the probability is at least a half here. Terms that
  // increase would overflow a double.
  const double mean = static_cast<double>(tested) * static_cast<double>(all_valid) / static_cast<double>(viewpoints);
  if (static_cast<double>(first) <= std::floor(mean)) return 0.5;
  const std::uint64_t last = std::min(tested, all_valid);
  double sum = 1.0, term = 1.0;
  for (std::uint64_t x = first; x < last; ++x) {
    term *= static_cast<double>(all_valid - x) / static_cast<double>(x + 1) * static_cast<double>(tested - x) /
            static_cast<double>(invalid + x + 1 - tested);
    sum += term;
    if (term < sum * 1e-16) break;
  }
  return std::exp(log_choose(all_valid, first) + log_choose(invalid, tested - first) - log_choose(viewpoints, tested)) *
         sum;
}

}  // namespace

std::uint64_t valid_at_least(std::uint64_t viewpoints, std::uint64_t tested, std::uint64_t valid, double risk) {
  // The probability grows with the number of valid viewpoints. The result is the lowest number whose probability
  // exceeds the risk.
  std::uint64_t low = valid, high = viewpoints - (tested - valid);
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (at_least(viewpoints, middle, tested, valid) > risk)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace sightcell::bake
