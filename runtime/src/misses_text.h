#pragma once
// JSON text of reported misses.
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// Writes up to dst.size() bytes and returns the size of the text. All misses must satisfy can_be_written.
[[nodiscard]] std::size_t write_misses(std::span<const std::uint8_t, 16> scene_fingerprint,
                                       std::span<const sightcell_miss> misses, std::span<char> dst) noexcept;
[[nodiscard]] bool can_be_written(const sightcell_miss& miss, std::uint32_t polygon_count) noexcept;

}  // namespace sightcell::runtime
