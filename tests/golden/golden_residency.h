#pragma once
// The golden file with a texture residency section.
#include <cstddef>
#include <vector>

#include "golden_contents.h"
#include "unit/format/residency_samples.h"

namespace sightcell::test {

sample_contents residency_golden_contents();
std::vector<std::byte> residency_golden_bytes();

}  // namespace sightcell::test
