#pragma once
// Reads prefix codes (SPEC.md, "Code tables"): a u8, the number of listed symbols, then the lengths of their codes,
// four bits each, the lower half of a byte first. Symbols that are not listed have no code. The counterpart for writing
// is code_table_writer.h.
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefix_code.h"

namespace sightcell::format {

// Reads the lengths at the begin of bytes and moves bytes to their end. False if they are invalid.
[[nodiscard]] bool read_code_lengths(std::span<const std::byte>& bytes, symbol_lengths& lengths) noexcept;
// The same as a code.
[[nodiscard]] bool read_code(std::span<const std::byte>& bytes, prefix_code& code) noexcept;

}  // namespace sightcell::format
