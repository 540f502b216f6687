#pragma once
// What a moving camera may reach soon, and when.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cell_box.h"

namespace sightcell::runtime {

// A part of a scene that a camera may reach.
struct wish {
  int step = 0;          // time step at which it may be reached
  double squared = 0.0;  // distance from the predicted position at that time, square meters
  std::uint32_t part = 0;

  [[nodiscard]] bool before(const wish& other) const noexcept {
    if (step != other.step) return step < other.step;
    return squared < other.squared || (squared == other.squared && part < other.part);
  }
};

// The predicted path of a camera: a position and a sideways reach for each time step.
class way_ahead {
 public:
  // least_speed: meters per second. A slower camera is taken to reach as far sideways as one of this speed.
  way_ahead(const point& eye, const point& velocity, double seconds, double margin, double least_speed = 0.0) noexcept {
    const double speed = std::sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]);
    for (int step = 0; step <= time_steps; ++step) {
      const double time = seconds * step / time_steps;
      // Plus half the distance of a step, so that consecutive steps leave no gap.
      const double reach = margin + turn * std::max(speed, least_speed) * time + 0.5 * speed * seconds / time_steps;
      const auto at = static_cast<std::size_t>(step);
      for (std::size_t axis = 0; axis < 3; ++axis) positions_[at][axis] = eye[axis] + velocity[axis] * time;
      squared_reach_[at] = reach * reach;
    }
  }

  // False if the box is not reached.
  [[nodiscard]] bool reaches(const wide_box& b, wish& out) const noexcept {
    for (std::size_t step = 0; step <= time_steps; ++step) {
      const double away = squared_distance(b, positions_[step]);
      if (away > squared_reach_[step]) continue;
      out.step = static_cast<int>(step);
      out.squared = away;
      return true;
    }
    return false;
  }

 private:
  static constexpr int time_steps = 16;
  static constexpr double turn = 0.5;  // sideways distance per distance traveled

  std::array<point, time_steps + 1> positions_;
  std::array<double, time_steps + 1> squared_reach_;
};

// The parts that may be reached first, each once.
class first_wishes {
 public:
  void take(const wish& w) noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (wishes_[i].part != w.part) continue;
      if (!w.before(wishes_[i])) return;
      std::copy(wishes_.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                wishes_.begin() + static_cast<std::ptrdiff_t>(count_),
                wishes_.begin() + static_cast<std::ptrdiff_t>(i));
      --count_;
      break;
    }
    if (count_ == wishes_.size() && !w.before(wishes_.back())) return;
    std::size_t at = count_ == wishes_.size() ? count_ - 1 : count_++;
    for (; at > 0 && w.before(wishes_[at - 1]); --at) wishes_[at] = wishes_[at - 1];
    wishes_[at] = w;
  }
  [[nodiscard]] std::span<const wish> wishes() const noexcept { return {wishes_.data(), count_}; }

 private:
  static constexpr std::size_t most_wishes = 64;

  std::array<wish, most_wishes> wishes_{};
  std::size_t count_ = 0;
};

}  // namespace sightcell::runtime
