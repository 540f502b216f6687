#pragma once
// Plans when a growing batch of verification rays is tested, so that it ends as soon as it proves enough.
#include <cstdint>
#include <vector>

namespace sightcell::bake {

// One interim test of a batch. It succeeds if at most `misses` of the first `trials` trials missed. The bound is then
// at most the target, with a confidence of 1 - risk.
struct interim_test {
  std::uint64_t misses = 0, trials = 0;
  double risk = 0.0;  // probability that the bound of this interim test is too low
};

// Returns the interim tests of one batch, by ascending number of misses; the last allows 64.
// The plan is made before the first ray. The risks of all interim tests sum to at most `risk`, so all of their bounds
// hold at once with a confidence of 1 - risk, and the batch may end at any of them. This is a group sequential test
// that spends its risk test by test (Pocock 1977, Lan and DeMets 1983). Interim test m, from 0, has the share 1 / ((m +
// 1)(m + 2)) of the risk.
// target: the error to prove.
// share_of_places: the part of the risk of each interim test that the lower limit of its trials takes
//   (cast_bound_rays()). Its bound has the rest.
std::vector<interim_test> plan_interim_tests(double target, double risk, double share_of_places);

// Returns the approximate number of trials until an interim test succeeds, if each trial misses with probability p. It
// is that of the first test which succeeds with a probability of at least one half; infinity if there is none.
// misses, trials: results so far.
double expected_trials(const std::vector<interim_test>& interim_tests, double p, std::uint64_t misses = 0,
                       std::uint64_t trials = 0);

}  // namespace sightcell::bake
