#include "golden_lights.h"

namespace sightcell::test {

sample_contents light_golden_contents() {
  return volume_contents();
}

std::vector<std::byte> light_golden_bytes() {
  const sample_contents contents = light_golden_contents();
  return with_lights(contents.encode(), sample_lights(contents));
}

}  // namespace sightcell::test
