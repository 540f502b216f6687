#include "box_cover.h"

namespace sightcell::runtime {
namespace {

constexpr int most_pieces = 4096;

// Cuts the part of a box that the first cell leaves into boxes, and tests each of them against the other cells. rest:
// half-open. pieces: the number of boxes that may still be tested.
bool rest_is_covered(wide_box rest, std::span<const located_cell> cells, float margin, int& pieces) noexcept {
  while (!cells.empty() && !boxes_meet(rest, widened(cells.front().bounds, margin))) cells = cells.subspan(1);
  if (cells.empty() || --pieces < 0) return false;
  const wide_box cell = widened(cells.front().bounds, margin);
  cells = cells.subspan(1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (rest.min[axis] < cell.min[axis]) {
      wide_box below = rest;
      below.max[axis] = cell.min[axis];
      if (!rest_is_covered(below, cells, margin, pieces)) return false;
      rest.min[axis] = cell.min[axis];
    }
    if (rest.max[axis] > cell.max[axis]) {
      wide_box above = rest;
      above.min[axis] = cell.max[axis];
      if (!rest_is_covered(above, cells, margin, pieces)) return false;
      rest.max[axis] = cell.max[axis];
    }
  }
  return true;
}

}  // namespace

bool cells_cover(const wide_box& closed, std::span<const located_cell> cells, float margin) noexcept {
  wide_box all = closed;
  for (double& end : all.max) end = end < any_volume ? next_above(end) : end;
  int pieces = most_pieces;
  return rest_is_covered(all, cells, margin, pieces);
}

}  // namespace sightcell::runtime
