#include "stored_sets.h"

#include <bit>

namespace sightcell::format {

stored_sets::stored_sets(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw,
                         std::span<const std::vector<std::uint32_t>> orders) {
  const std::uint32_t polygons = draws.empty() ? 0 : draws.back().first_stored + draws.back().polygon_count;
  stored_of_source_.resize(polygons);
  members_.resize(polygons / 64 + 1);
  for (std::size_t d = 0; d < draws.size(); ++d) {
    const std::vector<std::uint32_t>& order = orders[order_of_draw[d]];
    for (std::uint32_t i = 0; i < draws[d].polygon_count; ++i) {
      stored_of_source_[draws[d].first_source + order[i]] = draws[d].first_stored + i;
    }
  }
}

// Through a bit for each polygon: sorting the stored numbers takes several times as long.
void stored_sets::runs_of(std::span<const std::uint32_t> source_ids, std::vector<run>& runs) {
  runs.clear();
  for (const std::uint32_t id : source_ids) {
    const std::uint32_t stored = stored_of_source_[id];
    members_[stored / 64] |= std::uint64_t{1} << (stored % 64);
  }
  std::uint64_t before = 0;  // the bit of the polygon in front of the word
  for (std::size_t word = 0; word < members_.size(); ++word) {
    const std::uint64_t bits = members_[word];
    for (std::uint64_t left = bits ^ (bits << 1 | before); left != 0; left &= left - 1) {
      const auto border = static_cast<std::uint32_t>(64 * word) + static_cast<std::uint32_t>(std::countr_zero(left));
      if (runs.empty() || runs.back().count != 0) {
        runs.push_back({border, 0});
      } else {
        runs.back().count = border - runs.back().first;
      }
    }
    before = bits >> 63;
    members_[word] = 0;
  }
}

}  // namespace sightcell::format
