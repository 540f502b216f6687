#pragma once
// How many of many places are free, told from a few of them.
#include <cstdint>

namespace sightcell::bake {

// Of `places` independent places, all drawn alike, the first `tested` were tested and `free` of them are free. The
// fewest of all that can be free: with a probability of at least 1 - risk no fewer are. Exact: the lower end of a
// one-sided interval for a hypergeometric count (Clopper and Pearson's argument without replacement). tested at most
// places, free at most tested; risk in (0, 0.5).
std::uint64_t valid_at_least(std::uint64_t places, std::uint64_t tested, std::uint64_t free, double risk);

}  // namespace sightcell::bake
