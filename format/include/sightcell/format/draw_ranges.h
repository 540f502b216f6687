#pragma once
// Cuts runs of stored polygons at the borders of draws, or of draw groups in the merged layout. The writer (range
// bound), the reader (statistics) and the runtime (draw ranges) share it, so that all three count the same.
#include <algorithm>
#include <cstdint>
#include <span>

#include "sightcell/format/records.h"

namespace sightcell::format {

// Calls emit(draw, first, count) for each part of a run in one draw. A draw may be a draw group.
// runs: ascending, disjoint.
// first_of(d): stored number of the first polygon of draw d < draw_count; must not descend. Draws without polygons get
//   no part.
// polygon_count: the end of the last draw.
// first: counted from the first polygon of the draw.
// Allocates nothing; any thread. O(runs + draws met * log of the draws between them). Ends and stays below draw_count
// for any result of first_of.
template <class FirstOf, class Emit>
void for_each_draw_range(std::span<const run> runs, std::uint32_t draw_count, std::uint32_t polygon_count,
                         const FirstOf& first_of, const Emit& emit) {
  if (draw_count == 0) return;
  const auto end_of = [&](std::uint32_t d) -> std::uint64_t {
    return d + 1 < draw_count ? first_of(d + 1) : polygon_count;
  };
  std::uint32_t draw = 0;
  std::uint32_t draw_begin = first_of(0);
  std::uint64_t draw_end = end_of(0);
  for (const run& r : runs) {
    std::uint64_t place = r.first;
    const std::uint64_t end = place + r.count;
    // Most runs end in the draw in which the run before ended, so they begin in it too.
    while (end > draw_end) {
      if (place < draw_end) {
        emit(draw, static_cast<std::uint32_t>(place - draw_begin), static_cast<std::uint32_t>(draw_end - place));
        place = draw_end;
      }
      // Finds the last draw that starts at or before place, where the next one may start too. It is near in most cases,
      // because polygons that are visible together are stored together: steps double until they are too far, then
      // halve.
      if (++draw >= draw_count) return;
      const auto starts_by_place = [&](std::uint64_t d) {
        return d < draw_count && first_of(static_cast<std::uint32_t>(d)) <= place;
      };
      std::uint64_t step = 1;
      for (; starts_by_place(draw + step); step *= 2) draw += static_cast<std::uint32_t>(step);
      for (step /= 2; step > 0; step /= 2) draw += starts_by_place(draw + step) ? static_cast<std::uint32_t>(step) : 0u;
      draw_begin = first_of(draw);
      draw_end = end_of(draw);
    }
    if (place < end)
      emit(draw, static_cast<std::uint32_t>(place - draw_begin), static_cast<std::uint32_t>(end - place));
  }
}

}  // namespace sightcell::format
