#include "golden_importance.h"

#include "golden_contents.h"

namespace sightcell::test {

std::vector<std::byte> importance_golden_bytes() {
  return with_importance(ordered_contents().encode(), sample_class);
}

}  // namespace sightcell::test
