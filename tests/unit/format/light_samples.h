#pragma once
// Files with a lights section for tests.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightcell/format/light_writer.h"
#include "sightcell/format/reader.h"
#include "unit/format/sample_contents.h"

namespace sightcell::test {

// Ten lights: point lights, spot lights, one that reaches nothing. Light 9 reaches everything.
struct sample_lights {
  explicit sample_lights(const sample_contents& contents);

  std::vector<format::light_record> lights;
  std::vector<std::vector<std::uint32_t>> sets;  // of each light
  std::vector<std::vector<bool>> touching;       // of each cell, by light
  std::vector<format::certificate_record> certificate;

  // Refers to the members.
  format::light_source source() const;
};

// Fails the running test, and returns no bytes, if the writer fails.
std::vector<std::byte> with_lights(const std::vector<std::byte>& file, const sample_lights& lights);

// The source ids that each light reaches. Fails the running test if there are no lights.
std::vector<std::vector<std::uint32_t>> sets_of_lights(const format::reader& file);

// Decodes all of it, for the sanitizers.
format::status use_lights(const format::reader& file);

}  // namespace sightcell::test
