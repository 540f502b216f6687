#pragma once
// Lines along the edges of boxes near the eye of a view.
#include <cstdint>
#include <span>

#include "view.h"

namespace sightcell::runtime {

// CORRUPT: the region of the cell is damaged; count is unchanged.
[[nodiscard]] sightcell_status count_debug_lines(const sightcell_view& view, std::uint32_t kinds,
                                                 std::uint64_t& count) noexcept;
// dst: of the size that count_debug_lines returned. CORRUPT: the bytes of the file changed since then.
[[nodiscard]] sightcell_status write_debug_lines(const sightcell_view& view, std::uint32_t kinds,
                                                 std::span<sightcell_debug_line> dst) noexcept;

}  // namespace sightcell::runtime
