#include "bound/clopper_pearson.h"

#include <algorithm>
#include <cmath>

namespace sightcell::bake {
namespace {

// Returns P(X <= k) for X ~ Binomial(n, p). The sum starts with the term of k and goes down; each term is relative to
// that one. Below the mean the terms decrease, so the sum ends when they become negligible.
double cumulative(std::uint64_t k, std::uint64_t n, double p) {
  const double dn = static_cast<double>(n), dk = static_cast<double>(k);
  const double log_first = std::lgamma(dn + 1.0) - std::lgamma(dk + 1.0) - std::lgamma(dn - dk + 1.0) +
                           dk * std::log(p) + (dn - dk) * std::log1p(-p);
  // Far above the mean the sum is 1, but its terms are too small for a double.
  if (log_first < -700.0 && dk > dn * p) return 1.0;
  double sum = 1.0, term = 1.0;
  const double odds = (1.0 - p) / p;
  for (std::uint64_t i = k; i > 0; --i) {
    term *= static_cast<double>(i) / static_cast<double>(n - i + 1) * odds;
    sum += term;
    if (term < sum * 1e-16) break;
  }
  return std::exp(log_first) * sum;
}

}  // namespace

double clopper_pearson_upper(std::uint64_t misses, std::uint64_t trials, double confidence) {
  if (trials == 0 || misses >= trials) return 1.0;
  const double alpha = 1.0 - confidence;
  if (misses == 0) return -std::expm1(std::log(alpha) / static_cast<double>(trials));
  // Bisection: the cumulative probability falls with p, from about 1/2 at misses / trials to 0 at 1. If confidence is
  // below a half, the bound is below the rate, so the search starts at 0.
  double low = confidence > 0.75 ? static_cast<double>(misses) / static_cast<double>(trials) : 1e-300, high = 1.0;
  for (int i = 0; i < 200 && high - low > 1e-13 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (cumulative(misses, trials, middle) > alpha ? low : high) = middle;
  }
  return high;
}

std::uint64_t trials_without_miss(double target, double confidence) {
  return static_cast<std::uint64_t>(std::ceil(std::log(1.0 - confidence) / std::log1p(-target)));
}

std::uint64_t trials_allowing(std::uint64_t misses, double target, double confidence) {
  std::uint64_t low = trials_without_miss(target, confidence), high = low;
  if (misses == 0) return low;
  // The bound is at most the target if `misses` or fewer misses have a probability of at most 1 - confidence at the
  // target.
  const auto too_few = [&](std::uint64_t trials) { return cumulative(misses, trials, target) > 1.0 - confidence; };
  while (too_few(high)) high *= 2;
  while (high - low > high / 2000 + 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (too_few(middle) ? low : high) = middle;
  }
  return high + high / 1'000'000 + 1;  // margin for rounding: the bound must not exceed the target
}

double about_at_most(std::uint64_t misses, std::uint64_t trials, double p) {
  const double mean = static_cast<double>(trials) * p;
  double sum = 0.0, term = std::exp(-mean);
  for (std::uint64_t k = 0; k <= misses; ++k) {
    sum += term;
    term *= mean / static_cast<double>(k + 1);
  }
  return std::min(sum, 1.0);
}

}  // namespace sightcell::bake
