#pragma once
// The union of two sets within given numbers of runs and ranges.
#include <cstddef>
#include <span>

#include "ranges.h"

namespace sightcell::runtime {

// Writes the union of a and b to out, which overlaps neither; count: its runs. If out has not enough room for the runs,
// or there are more than most_ranges ranges, gaps inside draws are closed, the smallest first. This always succeeds if
// both limits are at least the number of draws with polygons; else the function may return false.
[[nodiscard]] bool write_union(run_span a, run_span b, range_borders borders, std::uint32_t most_ranges,
                               std::span<format::run> out, std::size_t& count) noexcept;

}  // namespace sightcell::runtime
