#pragma once
// Files with an importance section for tests.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sightcell/format/reader.h"

namespace sightcell::test {

// The class of a polygon (source id) in the set of a cell.
using class_function = std::function<std::uint8_t(std::uint32_t cell, std::uint32_t polygon)>;

// All classes, some more often than others, in runs.
std::uint8_t sample_class(std::uint32_t cell, std::uint32_t polygon);

// Fails the running test, and returns no bytes, if the writer fails.
std::vector<std::byte> with_importance(const std::vector<std::byte>& file, const class_function& class_of);

// The class of each polygon of a set, by ascending source id. Fails the running test if there are none.
std::vector<std::uint8_t> classes_of(const format::reader& file, std::uint32_t cell);

// Decodes all chunks and classes, for the sanitizers.
format::status use_importance(const format::reader& file);

// reseal(), and the checksums inside the importance section too, as far as it can be followed.
void reseal_importance(std::vector<std::byte>& file);

}  // namespace sightcell::test
