#include "prefetch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace sightcell::runtime {
namespace {

constexpr int time_steps = 16;
constexpr double turn = 0.5;  // sideways distance per distance traveled
constexpr std::size_t most_wishes = 64;

struct wish {
  int step = 0;          // time step at which it may be reached
  double squared = 0.0;  // distance from the predicted position at that time, square meters
  std::uint32_t chunk = 0;

  [[nodiscard]] bool before(const wish& other) const noexcept {
    if (step != other.step) return step < other.step;
    return squared < other.squared || (squared == other.squared && chunk < other.chunk);
  }
};

// The predicted path of a camera: a position and a sideways reach for each time step.
class way_ahead {
 public:
  way_ahead(const point& eye, const point& velocity, double seconds, double margin) noexcept {
    const double speed = std::sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]);
    for (int step = 0; step <= time_steps; ++step) {
      const double time = seconds * step / time_steps;
      // Plus half the distance of a step, so that consecutive steps leave no gap.
      const double reach = margin + turn * speed * time + 0.5 * speed * seconds / time_steps;
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
  std::array<point, time_steps + 1> positions_;
  std::array<double, time_steps + 1> squared_reach_;
};

// The chunks that may be reached first, each once.
class first_wishes {
 public:
  void take(const wish& w) noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (wishes_[i].chunk != w.chunk) continue;
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
  std::array<wish, most_wishes> wishes_{};
  std::size_t count_ = 0;
};

}  // namespace

void prefetch(const sightcell_db& db, const point& eye, const point& velocity, double seconds) noexcept {
  const way_ahead way(eye, velocity, seconds, static_cast<double>(db.file().facts().margin));
  first_wishes first;
  db.locator().for_each_group([&](const wide_box& bounds, std::uint32_t first_cell, std::uint32_t cells) {
    wish w;
    if (!way.reaches(bounds, w)) return;
    for (w.chunk = format::reader::chunk_of(first_cell); w.chunk <= format::reader::chunk_of(first_cell + cells - 1);
         ++w.chunk) {
      first.take(w);
    }
  });
  chunk_cache::wish_list list(db.cache());
  for (const wish& w : first.wishes()) {
    if (!list.add(w.chunk)) return;
  }
}

}  // namespace sightcell::runtime
