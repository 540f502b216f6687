#pragma once
// Computes the lengths of the best prefix code (prefix_code.h) with a limited number of bits from counts of symbols:
// Larmore and Hirschberg's package-merge (J. ACM 37, 1990).
#include <array>
#include <cstdint>

#include "prefix_code.h"

namespace sightcell::format {

using symbol_counts = std::array<std::uint64_t, symbol_count>;

// Length 0 for symbols that do not occur; a single symbol has 1 bit. Of equal counts the lower symbol has the shorter
// code.
// most_bits: enough for the symbols that occur. Allocates.
symbol_lengths best_lengths(const symbol_counts& counts, unsigned most_bits = longest_code);

}  // namespace sightcell::format
