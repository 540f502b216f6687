#pragma once
// Files with a casters section for tests.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightcell/format/caster_writer.h"
#include "sightcell/format/reader.h"
#include "unit/format/sample_contents.h"

namespace sightcell::test {

// Two suns, one of which moves, and for each cell and sun some polygons that the cell does not see.
struct sample_casters {
  explicit sample_casters(const sample_contents& contents);

  std::vector<format::sun_record> suns;
  std::vector<std::vector<std::uint32_t>> sets;  // the suns of a cell one after the other
  std::vector<format::certificate_record> certificate;

  // Refers to the members.
  format::caster_source source() const;
};

// Fails the running test, and returns no bytes, if the writer fails.
std::vector<std::byte> with_casters(const std::vector<std::byte>& file, const sample_casters& casters);

// The source ids of each caster set, by its number. Fails the running test if there are none.
std::vector<std::vector<std::uint32_t>> casters_of(const format::reader& file);

// Decodes all of it, for the sanitizers.
format::status use_casters(const format::reader& file);

}  // namespace sightcell::test
