#pragma once
// Boxes of view cells in double precision. Floats of a file and borders of grown boxes are exact enough in it; the
// position of a camera is the sum of the view's origin and the eye, so it is not a float.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "sightcell/format/records.h"

namespace sightcell::runtime {

inline constexpr std::uint32_t no_cell = 0xFFFFFFFFu;
inline constexpr double any_volume = std::numeric_limits<double>::infinity();

using point = std::array<double, 3>;  // meters, world space

// Half-open for positions: min <= p < max.
struct wide_box {
  point min{}, max{};
};

[[nodiscard]] constexpr wide_box widened(const format::box& b, float margin = 0.0f) noexcept {
  wide_box w;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    w.min[axis] = static_cast<double>(b.min[axis]) - static_cast<double>(margin);
    w.max[axis] = static_cast<double>(b.max[axis]) + static_cast<double>(margin);
  }
  return w;
}

// The neighbors of a number among floats or doubles, as std::nextafter returns them, without the mathematics library.
// Not for NaN, and not for the last number at either end.
[[nodiscard]] constexpr float next_below(float v) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(v);
  if (v == 0.0f) return std::bit_cast<float>(std::uint32_t{0x80000001u});
  return std::bit_cast<float>(v > 0.0f ? bits - 1 : bits + 1);
}
[[nodiscard]] constexpr double next_above(double v) noexcept {
  const auto bits = std::bit_cast<std::uint64_t>(v);
  if (v == 0.0) return std::bit_cast<double>(std::uint64_t{1});
  return std::bit_cast<double>(v > 0.0 ? bits + 1 : bits - 1);
}

// The largest floats that are not above a position. They are inside a box of floats exactly where the position is,
// since both ends of a half-open box are floats. NaN stays NaN.
using rounded_point = std::array<float, 3>;
[[nodiscard]] inline rounded_point rounded_down(const point& p) noexcept {
  rounded_point r;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    r[axis] = static_cast<float>(p[axis]);
    if (static_cast<double>(r[axis]) > p[axis]) r[axis] = next_below(r[axis]);
  }
  return r;
}

[[nodiscard]] constexpr bool holds(const format::box& b, const rounded_point& p) noexcept {
  return p[0] >= b.min[0] && p[0] < b.max[0] && p[1] >= b.min[1] && p[1] < b.max[1] && p[2] >= b.min[2] &&
         p[2] < b.max[2];
}
// False for NaN.
[[nodiscard]] constexpr bool holds(const wide_box& b, const point& p) noexcept {
  return p[0] >= b.min[0] && p[0] < b.max[0] && p[1] >= b.min[1] && p[1] < b.max[1] && p[2] >= b.min[2] &&
         p[2] < b.max[2];
}

// Cubic meters. Above 0 for a valid box.
[[nodiscard]] constexpr double volume_of(const format::box& b) noexcept {
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume *= static_cast<double>(b.max[axis]) - static_cast<double>(b.min[axis]);
  }
  return volume;
}

// Half-open boxes that only touch do not intersect.
[[nodiscard]] constexpr bool boxes_meet(const wide_box& a, const wide_box& b) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(a.min[axis] < b.max[axis] && b.min[axis] < a.max[axis])) return false;
  }
  return true;
}

// Whether a closed box, which may be a single point, intersects a half-open one.
[[nodiscard]] constexpr bool touches(const wide_box& closed, const wide_box& half_open) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(closed.min[axis] < half_open.max[axis] && half_open.min[axis] <= closed.max[axis])) return false;
  }
  return true;
}

// Squared distance from a position to a box in square meters, 0 inside.
[[nodiscard]] constexpr double squared_distance(const wide_box& b, const point& p) noexcept {
  double sum = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = b.min[axis] - p[axis];
    const double above = p[axis] - b.max[axis];
    const double away = below > 0.0 ? below : above > 0.0 ? above : 0.0;
    sum += away * away;
  }
  return sum;
}

}  // namespace sightcell::runtime
