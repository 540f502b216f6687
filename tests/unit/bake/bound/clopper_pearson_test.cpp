#include "bound/clopper_pearson.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/binomial.hpp>
#include <cmath>

namespace sightcell::bake {
namespace {

// Reference values by root finding on the exact binomial sum in 60-digit arithmetic.
TEST(clopper_pearson, agrees_with_exact_values) {
  EXPECT_NEAR(clopper_pearson_upper(0, 1, 0.95), 0.95, 1e-12);
  EXPECT_NEAR(clopper_pearson_upper(0, 1000, 0.95) / 2.9912495451e-3, 1.0, 1e-9);
  EXPECT_NEAR(clopper_pearson_upper(1, 10, 0.95) / 0.39416329, 1.0, 1e-7);
  EXPECT_NEAR(clopper_pearson_upper(5, 10, 0.95) / 0.77755890, 1.0, 1e-7);
}

// Boost.Math inverts the incomplete beta function; ours sums binomial terms.
TEST(clopper_pearson, agrees_with_boost_math) {
  using oracle = boost::math::binomial_distribution<double>;
  std::size_t compared = 0;
  for (const double n : {1., 2., 3., 10., 20., 100., 1e3, 1e4, 1e5, 1e6, 3e6, 1e7, 1e8, 1e9})
    for (const double k : {0., 1., 2., 3., 7., 17., 60., 300., 5e3, 1e5, n / 2 - 1, n / 2, n - 2, n - 1})
      for (const double confidence : {0.05, 0.3, 0.5, 0.76, 0.9, 0.95, 0.975, 0.99, 0.999, 1 - 1e-6, 1 - 1e-9}) {
        if (k < 0 || k >= n || k != std::floor(k) || (n > 1e7 && k > 1e5)) continue;
        const double ours =
            clopper_pearson_upper(static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(n), confidence);
        EXPECT_NEAR(ours / oracle::find_upper_bound_on_p(n, k, 1 - confidence), 1.0, 1e-12 + 5e-14 * n)
            << k << " of " << n << ", confidence " << confidence;
        ++compared;
      }
  EXPECT_GT(compared, 1'000u);
}

TEST(clopper_pearson, fewest_trials_agree_with_boost_math) {
  using oracle = boost::math::binomial_distribution<double>;
  for (const double target : {0.5, 1e-2, 1e-4, 1e-6})
    for (const double confidence : {0.9, 0.975, 0.999}) {
      const auto n = static_cast<double>(trials_without_miss(target, confidence));
      EXPECT_LE(oracle::find_upper_bound_on_p(n, 0, 1 - confidence), target);
      if (n > 1) {
        EXPECT_GT(oracle::find_upper_bound_on_p(n - 1, 0, 1 - confidence), target);
      }
    }
}

TEST(clopper_pearson, defines_itself) {
  // At the bound, the chance of so few misses is exactly 1 - confidence.
  for (const std::uint64_t n : {20ull, 1'000ull, 3'000'000ull})
    for (const std::uint64_t k : {1ull, 3ull, 17ull})
      for (const double confidence : {0.95, 0.975, 0.999}) {
        const double p = clopper_pearson_upper(k, n, confidence);
        double sum = 0.0;
        for (std::uint64_t i = 0; i <= k; ++i) {
          const double di = static_cast<double>(i), dn = static_cast<double>(n);
          sum += std::exp(std::lgamma(dn + 1) - std::lgamma(di + 1) - std::lgamma(dn - di + 1) + di * std::log(p) +
                          (dn - di) * std::log1p(-p));
        }
        EXPECT_NEAR(sum / (1.0 - confidence), 1.0, 1e-6) << k << " of " << n;
      }
}

TEST(clopper_pearson, edges) {
  EXPECT_EQ(clopper_pearson_upper(0, 0, 0.95), 1.0);
  EXPECT_EQ(clopper_pearson_upper(7, 7, 0.95), 1.0);
  const double many = clopper_pearson_upper(500'000, 1'000'000, 0.95);
  EXPECT_GT(many, 0.5);
  EXPECT_LT(many, 0.502);
}

TEST(clopper_pearson, fewest_trials) {
  for (const double target : {1e-2, 1e-3, 1e-6}) {
    const std::uint64_t n = trials_without_miss(target, 0.975);
    EXPECT_LE(clopper_pearson_upper(0, n, 0.975), target);
    EXPECT_GT(clopper_pearson_upper(0, n - 1, 0.975), target);
  }
}

TEST(clopper_pearson, trials_that_allow_misses) {
  for (const double target : {1e-2, 1e-5})
    for (const std::uint64_t misses : {0u, 1u, 7u, 60u}) {
      const std::uint64_t n = trials_allowing(misses, target, 0.975);
      EXPECT_LE(clopper_pearson_upper(misses, n, 0.975), target) << misses;
      EXPECT_GT(clopper_pearson_upper(misses, n - n / 500 - 2, 0.975), target) << misses;
    }
}

TEST(clopper_pearson, about_at_most) {
  EXPECT_NEAR(about_at_most(0, 100'000, 1e-5), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(about_at_most(2, 100'000, 1e-5), 2.5 * std::exp(-1.0), 1e-12);
  EXPECT_EQ(about_at_most(3, 1'000, 0.0), 1.0);
}

}  // namespace
}  // namespace sightcell::bake
