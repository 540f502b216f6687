#pragma once
// Bytes of one row -> cell set (SPEC.md, "Version 0"): its own runs, or what to remove from and add to the set of a
// reference cell. A set is a span of runs: ascending, disjoint, not touching. Only version 0 has such rows.
#include <cstddef>
#include <cstdint>
#include <span>

#include "checked_reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The first bytes of a row, and where its runs lie.
struct row_header {
  bool delta = false;
  std::uint32_t reference = 0;     // place of the reference cell in its chunk; only where delta
  std::uint32_t first_count = 0;   // own runs, or runs to remove
  std::uint32_t second_count = 0;  // runs to add; 0 for own rows
  varint_cursor first;             // bytes of the own runs, or of the runs to remove
  varint_cursor second;            // bytes of the runs to add
};

// False when the bytes begin no row.
[[nodiscard]] bool read_row_header(std::span<const std::byte> row, row_header& out) noexcept;

// Both write the set into out and its number of runs into count; corrupt when the row breaks a rule, leaves
// polygon_count or has more runs than out holds. Allocate nothing.
status decode_own_row(row_header row, std::uint32_t polygon_count, std::span<run> out, std::size_t& count) noexcept;
// reference: the set of the reference cell; out must not overlap it.
status decode_delta_row(row_header row, std::uint32_t polygon_count, std::span<const run> reference, std::span<run> out,
                        std::size_t& count) noexcept;

}  // namespace sightcell::format
