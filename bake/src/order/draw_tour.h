#pragma once
// The order of draws in a file. At the border of two draws, as few cells as possible should see only one of the two
// polygons there.
#include <cstdint>
#include <span>
#include <vector>

#include "order/bit_matrix.h"
#include "order/neighbor_lists.h"

namespace sightcell::bake {

// The two ends of draw d are 2 * d, its head, and 2 * d + 1, its tail. The row of an end has a bit for each cell whose
// set has the polygon there. One more row, the last, is for what is before the first draw and after the last: it is all
// 0.
constexpr std::uint32_t head_of(std::uint32_t draw) {
  return 2 * draw;
}
constexpr std::uint32_t tail_of(std::uint32_t draw) {
  return 2 * draw + 1;
}
constexpr std::uint32_t draw_of(std::uint32_t end) {
  return end / 2;
}
constexpr std::uint32_t other_end(std::uint32_t end) {
  return end ^ 1u;
}

class draw_tour {
 public:
  // Computes an order: greedy edges, then improve().
  // ends: one row per end and the last row of zeros.
  // flippable: for each draw, whether it may be stored tail first.
  // sorts: number of sorts that propose neighbors.
  // Threads: pairs of ends are compared on several threads.
  draw_tour(const bit_matrix& ends, std::span<const std::uint8_t> flippable, std::uint32_t sorts);

  // Shortens the order by moving single draws (Or-opt).
  // ends: may differ from those of the constructor.
  void improve(const bit_matrix& ends);

  // Returns the draws in their order, each as the end that is first: its tail if the draw is flipped.
  const std::vector<std::uint32_t>& entries() const { return entries_; }

 private:
  std::vector<std::uint8_t> flippable_;
  neighbor_lists near_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace sightcell::bake
