#pragma once
// How sure an error is.
#include <algorithm>
#include <cmath>

namespace sightcell::bench {

struct interval {
  double low = 0.0, high = 0.0;
};

// Of the mean of a Poisson variable that was found to be this: 95 %, both sides. Byar's approximation of the exact
// limits (Breslow and Day 1987), which holds for fractions too: within 1 %, but for low below 5, which is too low.
inline interval poisson_interval(double found) {
  constexpr double z = 1.959964;
  const auto limit = [](double n, double side) {
    const double root = 1.0 - 1.0 / (9.0 * n) + side * z / (3.0 * std::sqrt(n));
    return n * root * root * root;
  };
  return {found < 0.5 ? 0.0 : std::max(0.0, limit(found, -1.0)), limit(found + 1.0, 1.0)};
}

// misses: as if they were independent, so many; error is what they come to. rays: of which there were none, the error
// of which has to be bounded too.
inline interval error_interval(double error, double misses, double rays) {
  const interval of = poisson_interval(misses);
  if (misses <= 0.0) return {0.0, rays > 0.0 ? std::min(1.0, of.high / rays) : 1.0};
  return {error * of.low / misses, std::min(1.0, error * of.high / misses)};
}

}  // namespace sightcell::bench
