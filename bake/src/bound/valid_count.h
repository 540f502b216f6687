#pragma once
// Estimates the number of valid viewpoints among many from a test of some.
#include <cstdint>

namespace sightcell::bake {

// Returns a lower confidence limit for the number of valid viewpoints among `viewpoints` independent viewpoints of one
// distribution, of which the first `tested` were tested and `valid` passed the test. The true number is at least that
// with a probability of at least 1 - risk. The limit is exact: the lower end of a one-sided interval for a
// hypergeometric count (the argument of Clopper and Pearson without replacement).
// tested: at most viewpoints.
// valid: at most tested.
// risk: in (0, 0.5).
std::uint64_t valid_at_least(std::uint64_t viewpoints, std::uint64_t tested, std::uint64_t valid, double risk);

}  // namespace sightcell::bake
