#pragma once
// Writes the orders section. The counterpart for reading, polygon_orders.h, describes it.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

// Appends the section. Each order is a source_of_stored: a permutation of 0 .. its size - 1. Ascending sequences take
// the fewest bits. in_runs: as in a file with clusters.
void put_orders(std::span<const std::vector<std::uint32_t>> orders, std::vector<std::byte>& out, bool in_runs = false);

}  // namespace sightcell::format
