#pragma once
// Files with a texture residency section for tests.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/residency_writer.h"
#include "unit/format/sample_contents.h"

namespace sightcell::test {

// Three textures: one that all cells need at slowly changing levels, one of a single texel, one that some cells need.
struct sample_residency {
  explicit sample_residency(const sample_contents& contents);

  std::vector<format::texture_record> textures;
  std::vector<std::vector<std::uint8_t>> levels;  // by cell
  float pixels_per_radian = 1000.0f, anisotropy = 16.0f;

  // Refers to the members.
  format::residency_source source() const;
};

// Fails the running test, and returns no bytes, if the writer fails.
std::vector<std::byte> with_residency(const std::vector<std::byte>& file, const sample_residency& residency);

// The levels of each cell. Fails the running test if there are none.
std::vector<std::vector<std::uint8_t>> levels_of(const format::reader& file);

// Decodes all of it, for the sanitizers.
format::status use_residency(const format::reader& file);

}  // namespace sightcell::test
