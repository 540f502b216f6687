#pragma once
// When a growing batch of fresh rays is looked at, so that it ends as soon as it proves enough.
#include <cstdint>
#include <vector>

namespace sightcell::bake {

// A batch ends well at a look if at most so many of its trials missed; the bound is then at or below the target with
// this look's confidence.
struct interim_test {
  std::uint64_t misses = 0, trials = 0;
  double risk = 0.0;  // of the bound of this look being too low
};

// A plan of looks at one batch, made before its first ray: their risks together are at most `risk`, so all of their
// bounds hold at once with a confidence of 1 - risk, and the batch may end at any of them (a group sequential test with
// its error spent look by look; Pocock 1977, Lan and DeMets 1983). Look m has the share 1 / ((m + 1)(m + 2)) of the
// risk. share_of_places: of a look's risk, what its trials' count takes (cast_bound_rays()); its bound has the rest.
// Ascending; the last allows 64 misses.
std::vector<interim_test> plan_interim_tests(double target, double risk, double share_of_places);

// About how many trials it takes until a look ends the batch well if each misses with probability p, `misses` of
// `trials` having missed already: the first at which that is as likely as not. Infinity where none is.
double expected_trials(const std::vector<interim_test>& interim_tests, double p, std::uint64_t misses = 0,
                       std::uint64_t trials = 0);

}  // namespace sightcell::bake
