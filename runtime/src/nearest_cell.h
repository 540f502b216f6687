#pragma once
// The cell nearest to a position outside all cells, and how far the position may move before another one can be nearer.
#include <cmath>
#include <cstdint>

#include "cell_box.h"

namespace sightcell::runtime {

// Takes cells one by one, in any order. Of several at the same distance the lowest number is the nearest.
class nearest_search {
 public:
  explicit nearest_search(const point& position) noexcept : position_(position) {}

  void take(const format::box& bounds, std::uint32_t cell) noexcept {
    const double away = squared_distance(widened(bounds), position_);
    if (away < best_ || (away == best_ && cell < cell_)) {
      second_ = best_;
      best_ = away;
      cell_ = cell;
      bounds_ = bounds;
    } else if (away < second_) {
      second_ = away;
    }
  }
  // Square meters.
  [[nodiscard]] double distance_to(const wide_box& b) const noexcept { return squared_distance(b, position_); }
  // True if a cell at this distance cannot change the result.
  [[nodiscard]] bool out_of_reach(double squared) const noexcept { return squared > second_; }

  // no_cell if no cell was taken.
  [[nodiscard]] std::uint32_t cell() const noexcept { return cell_; }
  [[nodiscard]] const format::box& bounds() const noexcept { return bounds_; }
  // Meters.
  [[nodiscard]] double distance() const noexcept { return std::sqrt(best_); }
  // Meters that the position may move in any direction while the cell stays the nearest. A distance changes by at most
  // the movement, so this is half of the difference to the second nearest cell, less a little for rounding.
  [[nodiscard]] double slack() const noexcept {
    const double gap = (std::sqrt(second_) - std::sqrt(best_)) * 0.499 - 1e-9 * std::sqrt(best_);
    return gap > 0.0 ? gap : 0.0;
  }

 private:
  point position_;
  format::box bounds_;
  double best_ = any_volume;  // square meters; infinite
  double second_ = any_volume;
  std::uint32_t cell_ = no_cell;
};

}  // namespace sightcell::runtime
