#pragma once
// The certificate of one row of a table (SPEC.md, "Certificate").
#include <array>
#include <bit>
#include <cstdint>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// Not checked.
[[nodiscard]] inline certificate_record certificate_of(
    const std::array<packed_column, layout::certificate_columns>& columns, std::uint32_t row,
    std::uint32_t cell) noexcept {
  const auto wide = [&](std::size_t which) {
    return std::uint64_t{columns[which + 1][row]} << 32 | columns[which][row];
  };
  return {.cell = cell,
          .rays = wide(0),
          .misses = wide(2),
          .upper_bound = static_cast<double>(std::bit_cast<float>(columns[4][row])),
          .confidence = static_cast<double>(std::bit_cast<float>(columns[5][row])),
          .seed = wide(6)};
}

}  // namespace sightcell::format
