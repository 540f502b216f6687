#pragma once
// Draw ranges -> indirect draw commands.
#include <cstddef>
#include <cstdint>

#include "view.h"

namespace sightcell::runtime {

// Commands of a view's set, where fewer than min_gap polygons of a draw between two of its ranges are drawn as well.
[[nodiscard]] std::uint64_t count_commands(const sightcell_view& view, std::uint32_t min_gap) noexcept;
// Writes as many, one every `stride` bytes from dst on, which may lie anywhere.
void write_commands(const sightcell_view& view, std::uint32_t min_gap, std::byte* dst, std::size_t stride) noexcept;

}  // namespace sightcell::runtime
