#include "bound/valid_count.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sightcell::bake {
namespace {

double log_choose(double n, double k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

// The chance of so many free ones among the tested.
double chance(int places, int all_free, int tested, int free) {
  if (free > all_free || tested - free > places - all_free) return 0.0;
  return std::exp(log_choose(all_free, free) + log_choose(places - all_free, tested - free) -
                  log_choose(places, tested));
}

TEST(valid_count, claims_too_much_no_more_often_than_the_risk) {
  // Exactly, over all outcomes: what is claimed is more than there is with a probability of risk at most.
  for (const int places : {10, 57, 200})
    for (const int tested : {1, 5, 10})
      for (const double risk : {0.2, 0.05, 0.001})
        for (int all_free = 0; all_free <= places; ++all_free) {
          double wrong = 0.0;
          for (int free = 0; free <= tested; ++free) {
            const auto claimed = valid_at_least(static_cast<std::uint64_t>(places), static_cast<std::uint64_t>(tested),
                                                static_cast<std::uint64_t>(free), risk);
            if (claimed > static_cast<std::uint64_t>(all_free)) wrong += chance(places, all_free, tested, free);
          }
          EXPECT_LE(wrong, risk * (1.0 + 1e-9)) << all_free << " of " << places << ", " << tested << " tested";
        }
}

TEST(valid_count, is_not_timid) {
  // All of 5,000 tested of 1,280,000 are free: at a risk of 0.0025 a share of 0.0012 may be otherwise.
  const std::uint64_t claimed = valid_at_least(1'280'000, 5'000, 5'000, 0.0025);
  EXPECT_NEAR(1.0 - static_cast<double>(claimed) / 1'280'000.0, 1.0 - std::pow(0.0025, 1.0 / 5'000.0), 1e-5);
  // A half of them: three standard deviations below a half.
  const std::uint64_t half = valid_at_least(1'280'000, 5'000, 2'500, 0.0025);
  EXPECT_NEAR(static_cast<double>(half) / 1'280'000.0, 0.5 - 2.807 * std::sqrt(0.25 / 5'000.0), 2e-4);
}

TEST(valid_count, large_batches) {
  // As many as a bake casts where few places are free: the middle of the range is then e^40000 times less likely.
  for (const double share : {0.01, 0.03, 0.27, 0.5, 0.97}) {
    const std::uint64_t places = 20'000'000, tested = places / 256;
    const auto free = static_cast<std::uint64_t>(share * static_cast<double>(tested));
    const std::uint64_t claimed = valid_at_least(places, tested, free, 0.00025);
    const double deviation = std::sqrt(share * (1.0 - share) / static_cast<double>(tested));
    EXPECT_LT(static_cast<double>(claimed) / 2e7, share - 3.0 * deviation) << share;
    EXPECT_GT(static_cast<double>(claimed) / 2e7, share - 4.5 * deviation) << share;
  }
}

TEST(valid_count, edges) {
  EXPECT_EQ(valid_at_least(100, 100, 37, 0.01), 37u) << "all were tested";
  EXPECT_EQ(valid_at_least(100, 50, 0, 0.01), 0u);
  EXPECT_EQ(valid_at_least(0, 0, 0, 0.01), 0u);
}

}  // namespace
}  // namespace sightcell::bake
