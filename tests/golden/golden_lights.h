#pragma once
// The golden file with a lights section.
#include <cstddef>
#include <vector>

#include "golden_contents.h"
#include "unit/format/light_samples.h"

namespace sightcell::test {

sample_contents light_golden_contents();
std::vector<std::byte> light_golden_bytes();

}  // namespace sightcell::test
