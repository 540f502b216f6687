#include "golden_importance.h"

namespace sightcell::test {

std::vector<golden_file_contents> golden_files_with_importance() {
  sample_contents chunks = ordered_contents();
  chunks.chunk_bytes = 150;
  return {{"v1_importance", ordered_contents()}, {"v1_chunks", chunks}};
}

std::vector<std::byte> importance_golden_bytes(const sample_contents& contents) {
  return with_importance(contents.encode(), sample_class);
}

}  // namespace sightcell::test
