#pragma once
// Local search that shortens a closed tour through all rows of a bit matrix: Or-opt and 2-opt with neighbor lists.
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

// Shortens a tour. The result is never longer and depends on the arguments alone.
// near: candidates for new edges.
// fixed: an edge of the tour that is kept.
// tour: each row of the matrix once; its last row is adjacent to its first.
// Cost: about 30 bytes of memory per row.
void improve_tour(const bit_matrix& matrix, const neighbor_lists& near, tour_edge fixed,
                  std::vector<std::uint32_t>& tour);

}  // namespace sightcell::bake
