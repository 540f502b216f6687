#pragma once
// The order of rows of a bit matrix in which rows side by side differ in few bits: a short travelling salesman's path
// over the Hamming distance.
#include <cstdint>
#include <vector>

#include "order/bit_matrix.h"

namespace sightcell::bake {

struct tour_settings {
  std::uint32_t sorts = 16;     // that propose neighbors
  std::uint32_t neighbors = 8;  // kept per row; at least 1
};

// A short path through all rows of the matrix, which begins in the last row but one and ends in the last; the answer
// is the rows between in their order. At least two rows. By greedy edges, then as improved_path does.
//
// The result depends on nothing but the arguments; long loops run on several threads. Takes, beside the matrix, up to
// 20 * neighbors + 60 bytes per row.
std::vector<std::uint32_t> shortest_path(const bit_matrix& matrix, const tour_settings& how);

// The same from a path that is known already: no longer than that one.
std::vector<std::uint32_t> improved_path(const bit_matrix& matrix, const std::vector<std::uint32_t>& path,
                                         const tour_settings& how);

}  // namespace sightcell::bake
