#pragma once
// The cell that lies nearest to a place outside all cells, and how far the place may go before that can change.
#include <cmath>
#include <cstdint>

#include "cell_box.h"

namespace sightcell::runtime {

// Cells are shown to it one by one, in any order. Of those at the same distance the lowest number is the nearest.
class nearest_search {
 public:
  explicit nearest_search(const point& place) noexcept : place_(place) {}

  void take(const format::box& bounds, std::uint32_t cell) noexcept {
    const double away = squared_distance(widened(bounds), place_);
    if (away < best_ || (away == best_ && cell < cell_)) {
      second_ = best_;
      best_ = away;
      cell_ = cell;
      bounds_ = bounds;
    } else if (away < second_) {
      second_ = away;
    }
  }
  // Square metres.
  [[nodiscard]] double distance_to(const wide_box& b) const noexcept { return squared_distance(b, place_); }
  // Nothing as far away as that can change the answer.
  [[nodiscard]] bool out_of_reach(double squared) const noexcept { return squared > second_; }

  // no_cell when none was shown.
  [[nodiscard]] std::uint32_t cell() const noexcept { return cell_; }
  [[nodiscard]] const format::box& bounds() const noexcept { return bounds_; }
  // Metres.
  [[nodiscard]] double distance() const noexcept { return std::sqrt(best_); }
  // Metres by which the place may move in any direction while the cell stays the nearest: a distance changes by no more
  // than the place moves, so half of what the second one is farther away. A little less, for rounding.
  [[nodiscard]] double slack() const noexcept {
    const double gap = (std::sqrt(second_) - std::sqrt(best_)) * 0.499 - 1e-9 * std::sqrt(best_);
    return gap > 0.0 ? gap : 0.0;
  }

 private:
  point place_;
  format::box bounds_;
  double best_ = any_volume;  // square metres; infinite
  double second_ = any_volume;
  std::uint32_t cell_ = no_cell;
};

}  // namespace sightcell::runtime
