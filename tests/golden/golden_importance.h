#pragma once
// The golden files with an importance section.
#include <cstddef>
#include <vector>

#include "golden_contents.h"
#include "unit/format/importance_samples.h"

namespace sightcell::test {

// Their contents; the classes are those of sample_class. One of them has smaller chunks than 64 cells.
std::vector<golden_file_contents> golden_files_with_importance();

std::vector<std::byte> importance_golden_bytes(const sample_contents& contents);

}  // namespace sightcell::test
