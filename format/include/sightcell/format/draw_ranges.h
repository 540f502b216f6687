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
// Allocates nothing; any thread. O(runs + draws met * log draws between them). Ends and stays inside draw_count even
// when first_of answers nonsense.
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
    // Most runs end in the draw that the one before ended in, and then began in it.
    while (end > draw_end) {
      if (place < draw_end) {
        emit(draw, static_cast<std::uint32_t>(place - draw_begin), static_cast<std::uint32_t>(draw_end - place));
        place = draw_end;
      }
      // The last draw that starts at or before place, as the next one does. It is most often near, because what is seen
      // together is stored together: steps double until they are too far, then halve.
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
