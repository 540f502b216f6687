#pragma once
// Converts runs of stored polygons to draw ranges of the C API; the difference of two sets in ranges.
#include <cstdint>
#include <span>

#include "sightcell/format/draw_ranges.h"
#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// Stored number of the first polygon of each draw, or draw group of a merged file, then the polygon count; ascending.
// "draw" means either one below.
using range_borders = std::span<const std::uint32_t>;
using run_span = std::span<const format::run>;

// Calls emit(draw, first, count) for each range of a set.
template <class Emit>
void for_each_range(run_span set, range_borders borders, const Emit& emit) {
  const auto draws = static_cast<std::uint32_t>(borders.size() - 1);
  format::for_each_draw_range(
      set, draws, borders.back(), [borders](std::uint32_t d) { return borders[d]; }, emit);
}

// Writes the ranges of a set, up to dst.size(). Returns their number.
[[nodiscard]] std::size_t write_ranges(run_span set, range_borders borders, std::span<sightcell_range> dst) noexcept;

// The number of ranges of a without b.
[[nodiscard]] std::uint64_t count_difference(run_span a, run_span b, range_borders borders) noexcept;
// Writes count_difference ranges.
void write_difference(run_span a, run_span b, range_borders borders, sightcell_range* dst) noexcept;
// Writes the runs of a without b, up to dst.size(). Returns their number.
[[nodiscard]] std::size_t write_difference(run_span a, run_span b, std::span<format::run> dst) noexcept;

}  // namespace sightcell::runtime
