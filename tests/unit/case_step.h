#pragma once
// How much of the longest loops of tests runs.
#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace sightcell::test {

// Returns the step of a loop over bytes, rounds or positions: 1 in complete runs (scripts/test --all), else the
// environment's SIGHTCELL_TEST_STEP. An odd step still changes every byte of some record of each kind.
inline std::size_t case_step() {
  const char* text = std::getenv("SIGHTCELL_TEST_STEP");
  return text == nullptr ? 1 : static_cast<std::size_t>(std::max(1, std::atoi(text)));
}

}  // namespace sightcell::test
