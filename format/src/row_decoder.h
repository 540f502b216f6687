#pragma once
// Decodes rows of version 0 (SPEC.md, "Version 0"): own runs, or runs to remove from and to add to the set of a
// reference cell. A set is a span of runs: ascending, disjoint, not touching.
#include <cstddef>
#include <cstdint>
#include <span>

#include "checked_reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The header of a row, and its lists of runs.
struct row_header {
  bool delta = false;
  std::uint32_t reference = 0;     // index of the reference cell in its chunk; only where delta
  std::uint32_t first_count = 0;   // own runs, or runs to remove
  std::uint32_t second_count = 0;  // runs to add; 0 for own rows
  varint_cursor first;             // bytes of the own runs, or of the runs to remove
  varint_cursor second;            // bytes of the runs to add
};

// False if the bytes are not the begin of a row.
[[nodiscard]] bool read_row_header(std::span<const std::byte> row, row_header& out) noexcept;

// Both write the set into out and its number of runs into count. corrupt: the row breaks a rule, exceeds polygon_count
// or has more runs than out. Allocate nothing.
status decode_own_row(row_header row, std::uint32_t polygon_count, std::span<run> out, std::size_t& count) noexcept;
// reference: the set of the reference cell; out must not overlap it.
status decode_delta_row(row_header row, std::uint32_t polygon_count, std::span<const run> reference, std::span<run> out,
                        std::size_t& count) noexcept;

}  // namespace sightcell::format
