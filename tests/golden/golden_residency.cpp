#include "golden_residency.h"

namespace sightcell::test {

sample_contents residency_golden_contents() {
  return volume_contents();
}

std::vector<std::byte> residency_golden_bytes() {
  const sample_contents contents = residency_golden_contents();
  return with_residency(contents.encode(), sample_residency(contents));
}

}  // namespace sightcell::test
