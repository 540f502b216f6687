#pragma once
// Exact confidence bounds of a binomial proportion.
#include <cstdint>

namespace sightcell::bake {

// Returns the one-sided upper Clopper-Pearson bound (Clopper and Pearson 1934): the largest p for which at most
// `misses` misses in `trials` independent trials still have a probability of at least 1 - confidence. 1 if trials is 0
// or all trials missed.
// confidence: in (0, 1).
// The bound uses no normal approximation. The relative error of the computed value grows with the number of trials,
// because large logarithms of factorials cancel: 1e-10 with 10,000 trials, 1e-6 with 10 million.
double clopper_pearson_upper(std::uint64_t misses, std::uint64_t trials, double confidence);

// Returns the smallest number of trials whose bound is at most target if none misses: ln(1 - confidence) / ln(1 -
// target).
std::uint64_t trials_without_miss(double target, double confidence);

// Returns the smallest number of trials whose bound is at most target if `misses` of them miss. The result may be too
// large by up to a thousandth, and is never too small.
std::uint64_t trials_allowing(std::uint64_t misses, double target, double confidence);

// Returns approximately the probability of at most `misses` misses in `trials` independent trials that each miss with
// probability p. It is that of the Poisson distribution (Poisson 1837), and is for planning alone.
double about_at_most(std::uint64_t misses, std::uint64_t trials, double p);

}  // namespace sightcell::bake
