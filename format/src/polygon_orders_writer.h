#pragma once
// Orders -> the orders section. polygon_orders.h is the way back and says what they are.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

// Appends the section. Each order: source_of_stored, a permutation of 0 .. its size - 1. Stretches that ascend take the
// fewest bits.
void put_orders(std::span<const std::vector<std::uint32_t>> orders, std::vector<std::byte>& out);

}  // namespace sightcell::format
