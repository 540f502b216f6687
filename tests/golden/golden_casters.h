#pragma once
// The golden file with a casters section.
#include <cstddef>
#include <vector>

#include "golden_contents.h"
#include "unit/format/caster_samples.h"

namespace sightcell::test {

sample_contents caster_golden_contents();
std::vector<std::byte> caster_golden_bytes();

}  // namespace sightcell::test
