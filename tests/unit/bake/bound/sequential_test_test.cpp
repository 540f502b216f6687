#include "bound/sequential_test.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bound/clopper_pearson.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

TEST(interim_tests, bound_the_target_at_their_own_risk) {
  const auto interim_tests = plan_interim_tests(1e-4, 0.025, 0.01);
  ASSERT_GT(interim_tests.size(), 5u);
  double risk = 0.0;
  for (std::size_t m = 0; m < interim_tests.size(); ++m) {
    const interim_test& one = interim_tests[m];
    risk += one.risk;
    EXPECT_LE(clopper_pearson_upper(one.misses, one.trials, 1.0 - 0.99 * one.risk), 1e-4);
    EXPECT_GT(clopper_pearson_upper(one.misses, one.trials * 99 / 100, 1.0 - 0.99 * one.risk), 1e-4) << "no longer";
    if (m > 0) {
      EXPECT_GT(one.trials, interim_tests[m - 1].trials);
      EXPECT_GT(one.misses, interim_tests[m - 1].misses);
    }
  }
  EXPECT_LE(risk, 0.025);
  EXPECT_GT(risk, 0.9 * 0.025) << "nearly all of it is used";
}

TEST(interim_tests, more_is_expected_where_more_misses) {
  const auto interim_tests = plan_interim_tests(1e-4, 0.025, 0.01);
  EXPECT_EQ(expected_trials(interim_tests, 0.0), static_cast<double>(interim_tests.front().trials));
  double before = 0.0;
  for (const double p : {1e-6, 1e-5, 2e-5, 4e-5, 6e-5}) {
    EXPECT_GE(expected_trials(interim_tests, p), before);
    before = expected_trials(interim_tests, p);
  }
  EXPECT_GT(before, static_cast<double>(interim_tests.front().trials));
  EXPECT_TRUE(std::isinf(expected_trials(interim_tests, 1e-4)));
  // Two that missed already: the look that allows two is the first that can do.
  EXPECT_EQ(expected_trials(interim_tests, 0.0, 2, 1'000), static_cast<double>(interim_tests[2].trials));
}

// A set that is as wrong as the target allows, or a little more, must not pass more often than the risk says, however
// many looks there are.
TEST(interim_tests, a_wrong_set_passes_as_rarely_as_the_risk_says) {
  constexpr double target = 1e-3, risk = 0.05;
  const auto interim_tests = plan_interim_tests(target, risk, 0.01);
  constexpr int runs = 4'000;
  int passed = 0;
  for (int run = 0; run < runs; ++run) {
    random_stream random(1, static_cast<std::uint64_t>(run), purpose::verify);
    // Gaps between misses are geometric.
    std::uint64_t trials = 0, misses = 0;
    std::size_t next = 0;
    while (next < interim_tests.size()) {
      const double uniform = (static_cast<double>(random.bits() >> 11) + 0.5) * 0x1p-53;
      trials += 1 + static_cast<std::uint64_t>(std::log(uniform) / std::log1p(-1.001 * target));
      bool well = false;
      for (; next < interim_tests.size() && interim_tests[next].trials < trials; ++next)
        well = well || misses <= interim_tests[next].misses;
      ++misses;
      if (!well) continue;
      ++passed;
      break;
    }
  }
  EXPECT_LE(passed, risk * runs + 2.0 * std::sqrt(risk * runs));
  EXPECT_GE(passed, 0.2 * risk * runs) << "it is not tighter than it needs to be by much";
}

}  // namespace
}  // namespace sightcell::bake
