#include "search/batch_plan.h"

#include <algorithm>
#include <cmath>

namespace sightcell::bake {
namespace {

// Estimates the cost that is left, in rays, with batches alone and with rounds of hemicubes before the next batch.
class plan_costs {
 public:
  plan_costs(const std::vector<interim_test>& interim_tests, double of_trial, double of_views)
      : interim_tests_(interim_tests), of_trial_(of_trial), of_views_(of_views) {}

  // With a batch now. If it is expected to fail, its first interim test shows that, and another round follows.
  double now(double missing, int round = 0) const {
    const double trials = expected_trials(interim_tests_, missing);
    if (std::isfinite(trials)) return of_trial_ * trials;
    return of_trial_ * static_cast<double>(interim_tests_.front().trials) + later(missing, round);
  }
  // With a round of hemicubes first. Each round is twice the size of the one before it.
  double later(double missing, int round = 0) const {
    constexpr int most_rounds = 12;
    if (round == most_rounds) return 0.0;
    return std::ldexp(of_views_, round) + now(left_after_round * missing, round + 1);
  }

 private:
  const std::vector<interim_test>& interim_tests_;
  double of_trial_, of_views_;
};

}  // namespace

double risk_of_batch(std::uint64_t batch) {
  return 0.05 / std::ldexp(1.0, static_cast<int>(std::min<std::uint64_t>(batch, 1000)));
}

bool batch_pays(const std::vector<interim_test>& interim_tests, std::span<const double> missing,
                std::uint64_t cost_of_hemicubes, double cost_of_trial) {
  const auto views = static_cast<double>(cost_of_hemicubes);
  if (missing.front() >= 1.0) return cost_of_trial * static_cast<double>(interim_tests.front().trials) <= views;
  const plan_costs costs(interim_tests, cost_of_trial, views);
  double now = 0.0, later = 0.0;
  for (const double m : missing) now += costs.now(m), later += costs.later(m);
  return now <= later;
}

}  // namespace sightcell::bake
