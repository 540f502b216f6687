#pragma once
// An order of the rows of a bit matrix in which adjacent rows differ in few bits: a short traveling salesman path over
// the Hamming distance.
#include <cstdint>
#include <vector>

#include "order/bit_matrix.h"

namespace sightcell::bake {

struct tour_settings {
  std::uint32_t sorts = 16;     // sorts that propose neighbors
  std::uint32_t neighbors = 8;  // neighbors that are kept per row; at least 1
};

// Returns the rows between the ends of a short path, in their order. The path begins in the row before the last, ends
// in the last row and visits all rows. It is built from greedy edges and then improved as by improved_path().
// matrix: at least two rows.
// Threads: long loops run on several threads. The result depends on the arguments alone.
// Cost: up to 20 * neighbors + 60 bytes of memory per row, besides the matrix.
std::vector<std::uint32_t> shortest_path(const bit_matrix& matrix, const tour_settings& how);

// As shortest_path(), from a path that is known. The result is never longer than that path.
std::vector<std::uint32_t> improved_path(const bit_matrix& matrix, const std::vector<std::uint32_t>& path,
                                         const tour_settings& how);

}  // namespace sightcell::bake
