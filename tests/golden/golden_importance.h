#pragma once
// The golden file with an importance section: v1_importance.
#include <cstddef>
#include <vector>

#include "unit/format/importance_samples.h"

namespace sightcell::test {

// ordered_contents() with the classes of sample_class.
std::vector<std::byte> importance_golden_bytes();

}  // namespace sightcell::test
