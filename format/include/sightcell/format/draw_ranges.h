#pragma once
// Cuts runs of stored polygons at the borders of what a host issues: draws, or draw groups of the merged layout. Used
// by the writer (range bound), the reader (statistics) and the runtime (draw ranges), so that all three count the same.
#include <algorithm>
#include <cstdint>
#include <span>

#include "sightcell/format/records.h"

namespace sightcell::format {

// A draw may be a draw group here. Calls emit(draw, first, count) for every piece of runs (ascending, disjoint) that
// lies in one draw; first counts from the draw's first stored polygon. first_of(d) gives that polygon for d <
// draw_count and must not descend; draws without polygons get no piece. polygon_count is the end of the last draw.
// Allocates nothing; any thread. O(runs + draws met * log draws). Ends and stays inside draw_count even when first_of
// answers nonsense.
template <class FirstOf, class Emit>
void for_each_draw_range(std::span<const run> runs, std::uint32_t draw_count, std::uint32_t polygon_count,
                         const FirstOf& first_of, const Emit& emit) {
  std::uint32_t draw = 0;
  const auto end_of = [&](std::uint32_t d) { return d + 1 < draw_count ? first_of(d + 1) : polygon_count; };
  for (const run& r : runs) {
    std::uint64_t place = r.first;
    const std::uint64_t end = place + r.count;
    while (place < end && draw < draw_count) {
      const std::uint64_t draw_end = end_of(draw);
      if (draw_end <= place) {
        // The next draw is the likely one; else the last draw that starts at or before place.
        std::uint32_t low = draw + 1;
        std::uint32_t high = draw_count;
        if (low < high && end_of(low) > place) high = low + 1;
        while (low < high) {
          const std::uint32_t middle = low + (high - low) / 2;
          if (first_of(middle) <= place) {
            low = middle + 1;
          } else {
            high = middle;
          }
        }
        draw = std::max(draw + 1, low - 1);
        continue;
      }
      const std::uint64_t stop = std::min(end, draw_end);
      emit(draw, static_cast<std::uint32_t>(place - first_of(draw)), static_cast<std::uint32_t>(stop - place));
      place = stop;
    }
  }
}

}  // namespace sightcell::format
