#pragma once
// What one of two sets holds, in room for no more runs and ranges than hosts have prepared for.
#include <cstddef>
#include <span>

#include "ranges.h"

namespace sightcell::runtime {

// Writes a and b together to out, which overlaps neither; count: of its runs. Where it were more runs than out has room
// for, or more ranges than most_ranges, gaps inside draws are closed, the smallest first. Both numbers are at least
// that of the draws that have polygons, so that it always fits; false where they are not.
[[nodiscard]] bool write_union(run_span a, run_span b, range_borders borders, std::uint32_t most_ranges,
                               std::span<format::run> out, std::size_t& count) noexcept;

}  // namespace sightcell::runtime
