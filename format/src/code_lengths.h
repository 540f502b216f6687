#pragma once
// Counts of symbols -> lengths of the best prefix code (prefix_code.h) with at most so many bits: Larmore and
// Hirschberg's package-merge (J. ACM 37, 1990).
#include <array>
#include <cstdint>

#include "prefix_code.h"

namespace sightcell::format {

using symbol_counts = std::array<std::uint64_t, symbol_count>;

// 0 for symbols that do not occur; one alone has 1 bit. Equal counts: the lower symbol has the shorter code. most_bits:
// enough for the symbols that occur. Allocates.
symbol_lengths best_lengths(const symbol_counts& counts, unsigned most_bits = longest_code);

}  // namespace sightcell::format
