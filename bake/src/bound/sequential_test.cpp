#include "bound/sequential_test.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "bound/clopper_pearson.h"

namespace sightcell::bake {

std::vector<interim_test> plan_interim_tests(double target, double risk, double share_of_places) {
  constexpr std::array<std::uint64_t, 13> misses{0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
  std::vector<interim_test> interim_tests;
  for (std::size_t m = 0; m < misses.size(); ++m) {
    const double own = risk / (static_cast<double>(m + 1) * static_cast<double>(m + 2));
    interim_tests.push_back({misses[m], trials_allowing(misses[m], target, 1.0 - (1.0 - share_of_places) * own), own});
  }
  return interim_tests;
}

double expected_trials(const std::vector<interim_test>& interim_tests, double p, std::uint64_t misses,
                       std::uint64_t trials) {
  for (const interim_test& one : interim_tests) {
    if (one.misses < misses) continue;
    const std::uint64_t more = one.trials - std::min(one.trials, trials);
    if (about_at_most(one.misses - misses, more, p) >= 0.5) return static_cast<double>(one.trials);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace sightcell::bake
