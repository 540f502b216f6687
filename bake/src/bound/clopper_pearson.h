#pragma once
// Exact binomial bounds.
#include <cstdint>

namespace sightcell::bake {

// One-sided upper Clopper-Pearson bound (Clopper and Pearson 1934): the largest p for which at most `misses` in
// `trials` independent trials still have a probability of at least 1 - confidence. 1 when trials is 0 or all missed.
// confidence in (0, 1). Exact in the sense that no normal approximation is made. The relative error of the result grows
// with the trials, because large logarithms of factorials cancel: 1e-10 with 10,000 trials, 1e-6 with 10 million.
double clopper_pearson_upper(std::uint64_t misses, std::uint64_t trials, double confidence);

// The fewest trials whose bound is at or below target when none misses: ln(1 - confidence) / ln(1 - target).
std::uint64_t trials_without_miss(double target, double confidence);

// The same when so many miss; not one too many by more than a thousandth.
std::uint64_t trials_allowing(std::uint64_t misses, double target, double confidence);

// The chance of at most `misses` in `trials` independent trials that each miss with probability p, as Poisson (1837)
// has it: for planning alone.
double about_at_most(std::uint64_t misses, std::uint64_t trials, double p);

}  // namespace sightcell::bake
