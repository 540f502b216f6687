#pragma once
// Exact binomial bounds.
#include <cstdint>

namespace sightcell::bake {

// One-sided upper Clopper-Pearson bound (Clopper and Pearson 1934): the largest p for which seeing at most `misses` in
// `trials` independent trials still has a probability of at least 1 - confidence. 1 when trials is 0 or all missed.
// confidence in (0, 1). Relative accuracy about 1e-10; exact in the sense that no normal approximation is made.
double clopper_pearson_upper(std::uint64_t misses, std::uint64_t trials, double confidence);

// The fewest trials whose bound is at or below target when none misses: ln(1 - confidence) / ln(1 - target).
std::uint64_t trials_without_miss(double target, double confidence);

}  // namespace sightcell::bake
