#pragma once
// Copies the host's indices of the polygons to draw.
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/records.h"
#include "sightcell/sightcell.h"

namespace sightcell::runtime {

// Copies the 3 indices of each polygon of runs to dst, without gaps. dst is written front to back, never read, and does
// not overlap stored_indices.
void copy_indices(std::span<const format::run> runs, const std::uint32_t* stored_indices, std::uint32_t* dst) noexcept;

// As an output of the C API: also sets count, in indices. CAPACITY, LIMIT; ARGUMENT without stored_indices.
sightcell_status write_indices(std::span<const format::run> runs, const std::uint32_t* stored_indices,
                               std::uint32_t* dst, std::size_t capacity, std::size_t* count) noexcept;

}  // namespace sightcell::runtime
