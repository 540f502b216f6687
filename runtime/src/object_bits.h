#pragma once
// Draws that have a polygon in a view's set -> one bit each.
#include <cstdint>
#include <span>

#include "view.h"

namespace sightcell::runtime {

// Writes all words; there are enough for all draws.
void write_object_bits(const sightcell_view& view, std::span<std::uint64_t> words) noexcept;

}  // namespace sightcell::runtime
