#include "golden_casters.h"

namespace sightcell::test {

sample_contents caster_golden_contents() {
  return volume_contents();
}

std::vector<std::byte> caster_golden_bytes() {
  const sample_contents contents = caster_golden_contents();
  return with_casters(contents.encode(), sample_casters(contents));
}

}  // namespace sightcell::test
