#pragma once
// The units in which (draw, first, count) ranges count: draws, or draw groups of the merged layout.
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

// Whether a draw begins another unit than the draw before it.
[[nodiscard]] inline bool begins_range_unit(std::span<const draw_record> draws, std::size_t number,
                                            host_layout layout) {
  return layout == host_layout::instanced || number == 0 || draws[number].group != draws[number - 1].group;
}

// Stored number of the first polygon of each unit, then the number of polygons. draws: must satisfy draw_table_rules.h.
[[nodiscard]] inline std::vector<std::uint32_t> range_borders(std::span<const draw_record> draws, host_layout layout) {
  std::vector<std::uint32_t> borders;
  for (std::size_t d = 0; d < draws.size(); ++d) {
    if (begins_range_unit(draws, d, layout)) borders.push_back(draws[d].first_stored);
  }
  borders.push_back(draws.empty() ? 0 : draws.back().first_stored + draws.back().polygon_count);
  return borders;
}

}  // namespace sightcell::format
