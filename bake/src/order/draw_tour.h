#pragma once
// The order in which draws are laid end to end: where one ends and the next begins as few cells as possible should see
// only one of the two.
#include <cstdint>
#include <span>
#include <vector>

#include "order/bit_matrix.h"
#include "order/neighbor_lists.h"

namespace sightcell::bake {

// The two ends of draw number d are 2 * d, its head, and 2 * d + 1, its tail. Their rows say which cells see them; one
// row more, the last, says what comes before the first draw and after the last: nothing is seen.
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
  // flippable: for each draw whether it may be laid tail first. sorts: that propose neighbors. Greedy edges, then
  // improve(). Many threads look at the pairs of ends.
  draw_tour(const bit_matrix& ends, std::span<const std::uint8_t> flippable, std::uint32_t sorts);

  // Moves single draws (Or-opt) while that makes the sum of distances smaller. ends may have changed.
  void improve(const bit_matrix& ends);

  // For each draw, in order, the end that comes first: its tail where the draw is flipped.
  const std::vector<std::uint32_t>& entries() const { return entries_; }

 private:
  std::vector<std::uint8_t> flippable_;
  neighbor_lists near_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace sightcell::bake
