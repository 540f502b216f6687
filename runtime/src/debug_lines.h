#pragma once
// Lines along the edges of boxes near the eye of a view.
#include <cstddef>
#include <cstdint>

#include "view.h"

namespace sightcell::runtime {

[[nodiscard]] std::uint64_t count_debug_lines(const sightcell_view& view, std::uint32_t kinds) noexcept;
// Writes count_debug_lines lines.
void write_debug_lines(const sightcell_view& view, std::uint32_t kinds, sightcell_debug_line* dst) noexcept;

}  // namespace sightcell::runtime
