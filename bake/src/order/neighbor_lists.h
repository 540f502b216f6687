#pragma once
// Candidates for the edges of a tour: for each row of a bit matrix some rows that are near by Hamming distance. All
// rows are sorted by randomly permuted bits, several times, and rows that are close to each other in a sort are
// proposed. Rows that differ in few bits have the same first set bits under most permutations.
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "order/bit_matrix.h"

namespace sightcell::bake {

constexpr std::uint32_t no_row = std::numeric_limits<std::uint32_t>::max();

struct near_row {
  std::uint32_t row = no_row;
  std::int32_t distance = std::numeric_limits<std::int32_t>::max();
};

// Memory: 8 bytes per row and kept neighbor.
class neighbor_lists {
 public:
  // kept: neighbors that each row keeps, at least 1.
  neighbor_lists(std::uint32_t rows, std::uint32_t kept) : kept_(kept), near_(std::size_t{rows} * kept) {}

  std::uint32_t kept() const { return kept_; }
  // Returns the neighbors of a row, nearest first, equally near ones in the order in which they were proposed. Unused
  // entries are last and have no_row.
  std::span<const near_row> of(std::uint32_t row) const {
    return std::span(near_).subspan(std::size_t{row} * kept_, kept_);
  }
  // Proposes `other` as a neighbor of `row`. May be called from several threads for different rows.
  void add(std::uint32_t row, std::uint32_t other, std::int32_t distance);
  // Proposes to each other all rows that are at most `ahead` positions apart in an order.
  // order: has no row twice.
  // Cost: 4 * ahead bytes of memory per row of order.
  void add_in_order(const bit_matrix& matrix, std::span<const std::uint32_t> order, std::uint32_t ahead);

 private:
  std::uint32_t kept_;
  std::vector<near_row> near_;
};

// Returns rows sorted by their first set bits after a random permutation of the columns. Ties keep their order.
// seed: names the permutation.
// Cost: 44 bytes of memory per row.
std::vector<std::uint32_t> sorted_by_permuted_bits(const bit_matrix& matrix, std::span<const std::uint32_t> rows,
                                                   std::uint64_t seed);

// Returns the neighbors that `sorts` sorts propose, with the seeds from first_seed on. Rows that are close to each
// other in `rows` are proposed first. With few rows, all pairs are compared instead.
neighbor_lists neighbors_by_sorts(const bit_matrix& matrix, std::span<const std::uint32_t> rows, std::uint32_t kept,
                                  std::uint32_t sorts, std::uint64_t first_seed);

}  // namespace sightcell::bake
