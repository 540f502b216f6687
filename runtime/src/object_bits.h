#pragma once
// A bit for each draw that has a polygon in the set of a view.
#include <cstdint>
#include <span>

#include "view.h"

namespace sightcell::runtime {

// Writes all words, of which there are enough for all draws.
void write_object_bits(const sightcell_view& view, std::span<std::uint64_t> words) noexcept;

}  // namespace sightcell::runtime
