#pragma once
// Candidates for the edges of a tour: for each row of a bit matrix some that are near by Hamming distance. They are
// looked for among those that come close to each other when all rows are sorted by randomly permuted bits: rows that
// differ in few bits share the first set ones under most permutations.
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

// 8 bytes per row and kept neighbor.
class neighbor_lists {
 public:
  // kept >= 1: how many a row keeps.
  neighbor_lists(std::uint32_t rows, std::uint32_t kept) : kept_(kept), near_(std::size_t{rows} * kept) {}

  std::uint32_t kept() const { return kept_; }
  // Nearest first; of equally near ones those that were proposed first. Places without a neighbor come last.
  std::span<const near_row> of(std::uint32_t row) const {
    return std::span(near_).subspan(std::size_t{row} * kept_, kept_);
  }
  // Proposes other to row. Several threads may do so for different rows.
  void add(std::uint32_t row, std::uint32_t other, std::int32_t distance);
  // Proposes to each other all rows that are at most ahead places apart in order, in which no row comes twice.
  // Takes 4 * ahead bytes per row of order meanwhile.
  void add_in_order(const bit_matrix& matrix, std::span<const std::uint32_t> order, std::uint32_t ahead);

 private:
  std::uint32_t kept_;
  std::vector<near_row> near_;
};

// The given rows in the order of a few of their first set bits after a permutation of all columns that seed names;
// ties stay as they come. Takes 44 bytes per row meanwhile.
std::vector<std::uint32_t> sorted_by_permuted_bits(const bit_matrix& matrix, std::span<const std::uint32_t> rows,
                                                   std::uint64_t seed);

// The neighbors that so many sorts propose (seeds first_seed and on) after those in the order in which rows come; all
// pairs are looked at where rows are few.
neighbor_lists neighbors_by_sorts(const bit_matrix& matrix, std::span<const std::uint32_t> rows, std::uint32_t kept,
                                  std::uint32_t sorts, std::uint64_t first_seed);

}  // namespace sightcell::bake
