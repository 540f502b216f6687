#pragma once
// Local search that makes a closed tour through all rows of a bit matrix shorter: Or-opt and 2-opt with neighbor lists.
#include <cstdint>
#include <span>
#include <vector>

#include "order/bit_matrix.h"
#include "order/neighbor_lists.h"

namespace sightcell::bake {

struct tour_edge {
  std::uint32_t a = 0, b = 0;
  bool joins(std::uint32_t x, std::uint32_t y) const { return (x == a && y == b) || (x == b && y == a); }
};

// tour: each row of the matrix once; its last is next to its first. fixed, an edge of the tour, stays one. The result
// is no longer than what came and depends on nothing but the arguments. Takes about 30 bytes per row meanwhile.
void improve_tour(const bit_matrix& matrix, const neighbor_lists& near, tour_edge fixed,
                  std::vector<std::uint32_t>& tour);

}  // namespace sightcell::bake
