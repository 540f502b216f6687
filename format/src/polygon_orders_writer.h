#pragma once
// Orders -> the orders section. polygon_orders.h is the way back and says what they are.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

struct polygon_order {
  std::vector<std::uint32_t> source_of_stored;  // a permutation of 0 .. its size - 1
  std::vector<bool> begins_atom;                // as many; the first is true
};

// Appends the section. Inside an atom polygons ascend in the order of the source: sort_atoms makes it so.
void put_orders(std::span<const polygon_order> orders, std::vector<std::byte>& out);

// Which of the polygons of an atom comes first changes no set, and ascending is what takes the fewest bits.
void sort_atoms(polygon_order& order);

}  // namespace sightcell::format
