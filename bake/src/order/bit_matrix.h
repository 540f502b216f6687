#pragma once
// Rows of bits and the Hamming distance between them, which measures a polygon order: two adjacent polygons cost as
// many run ends as there are columns in which their rows differ.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::bake {

class bit_matrix {
 public:
  bit_matrix() = default;
  // Makes a matrix of zeros with at least one column. The number of columns is rounded up to a multiple of 64.
  bit_matrix(std::uint32_t rows, std::uint32_t columns);

  std::uint32_t rows() const { return rows_; }
  std::uint32_t columns() const { return words_ * 64; }
  std::span<std::uint64_t> row(std::uint32_t r) { return std::span(bits_).subspan(offset(r), words_); }
  std::span<const std::uint64_t> row(std::uint32_t r) const { return std::span(bits_).subspan(offset(r), words_); }

  bool get(std::uint32_t r, std::uint32_t column) const {
    return (bits_[offset(r) + column / 64] >> (column % 64) & 1) != 0;
  }
  void toggle(std::uint32_t r, std::uint32_t column) {
    bits_[offset(r) + column / 64] ^= std::uint64_t{1} << (column % 64);
  }
  void clear(std::uint32_t r);

  // Returns the number of columns in which two rows differ.
  std::int32_t distance(std::uint32_t a, std::uint32_t b) const {
    return count_differences_(&bits_[offset(a)], &bits_[offset(b)], words_);
  }

 private:
  using counter = std::int32_t (*)(const std::uint64_t*, const std::uint64_t*, std::size_t);
  static counter best_counter();
  std::size_t offset(std::uint32_t r) const { return std::size_t{r} * words_; }

  std::uint32_t rows_ = 0, words_ = 0;
  std::vector<std::uint64_t> bits_;
  counter count_differences_ = nullptr;
};

// Returns the column of a matrix that represents `column` of `columns`. A matrix with fewer columns hashes several
// columns to one and adds them (exclusive or), which preserves small distances. Otherwise columns keep their numbers.
std::uint32_t folded_column(std::uint64_t column, std::uint64_t columns, const bit_matrix& matrix);

}  // namespace sightcell::bake
