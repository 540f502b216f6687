#pragma once
// Prefix codes as bytes (SPEC.md, "Code tables"): a u8, how many symbols are listed, then the lengths of their codes,
// four bits each, the lower half of a byte first. Symbols that are not listed have no code. code_table_writer.h is the
// way back.
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefix_code.h"

namespace sightcell::format {

// The lengths that bytes begin with; bytes is moved behind them. False when they are none.
[[nodiscard]] bool read_code_lengths(std::span<const std::byte>& bytes, symbol_lengths& lengths) noexcept;
// The same as a code.
[[nodiscard]] bool read_code(std::span<const std::byte>& bytes, prefix_code& code) noexcept;

}  // namespace sightcell::format
