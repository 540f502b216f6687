#pragma once
// Converts draw ranges to indirect draw commands.
#include <cstddef>
#include <cstdint>

#include "view.h"

namespace sightcell::runtime {

// The number of commands for the set of a view. Two ranges of a draw with fewer than min_gap polygons between them
// become one command, which draws these polygons too.
[[nodiscard]] std::uint64_t count_commands(const sightcell_view& view, std::uint32_t min_gap) noexcept;
// Writes these commands, one every `stride` bytes from dst on, at any alignment.
void write_commands(const sightcell_view& view, std::uint32_t min_gap, std::byte* dst, std::size_t stride) noexcept;

}  // namespace sightcell::runtime
