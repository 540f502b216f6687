#pragma once
// Volumes: places of a coarse cubic lattice where things that move can be. Each is an item of
// cell sets, with a number behind the last polygon: seen where a line from the cell passes it before anything hides it.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "cells/view_cell.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// What stands on the floor below an eye reaches so far up, metres, and so far to the sides at least.
inline constexpr double figure_height = 2.0, figure_reach = 0.5;

// The place begins at its numbers times the lattice's width.
struct volume_place {
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const volume_place&) const = default;
};

class volume_grid {
 public:
  // Most volumes of a scene, and most places of the box around them.
  static constexpr std::uint32_t most_volumes = 1u << 24;
  static constexpr std::uint64_t most_places = std::uint64_t{1} << 32;
  static constexpr std::uint32_t none = 0xFFFFFFFFu;

  // All places of a lattice of this width, anchored at the world's origin, that share volume with where figures are
  // whose eyes are in one of the cells: the cell's box, grown by margin, by figure_reach at least to the sides, down to
  // the floor under its lowest eye and up to the head above its highest. Throws sightcell::error "volumes.too-many".
  volume_grid(std::span<const view_cell> cells, double width, double margin);

  double width() const { return width_; }
  std::uint32_t count() const { return count_; }
  // By number, which is a matter of the places alone.
  const std::vector<volume_place>& places() const { return places_; }
  box box_of(std::uint32_t number) const;
  // The number of the volume at a place; none.
  std::uint32_t at(const volume_place& place) const;
  // Those that share a point with a box, ascending.
  std::vector<std::uint32_t> touching(const box& where) const;

  // Calls visit(number, distance at which the line enters it) for all volumes that a line passes before distance `to`,
  // the nearest first, until it answers false (Amanatides and Woo 1987). A place contains its lower borders and not its
  // upper ones; what the line only touches is not passed. In double, every border from its own number: no error adds
  // up on the way.
  template <typename Visit>
  void for_each_passed(const sight_line& line, double to, const Visit& visit) const;

 private:
  static constexpr std::int32_t part = 4;  // a chunk has so many places along each axis
  struct chunk {
    std::uint64_t mask = 0;   // bit 16 z + 4 y + x
    std::uint32_t first = 0;  // number of its first volume
  };
  struct range {
    std::array<std::int32_t, 3> first{}, last{};
  };

  range range_of(const glm::dvec3& min, const glm::dvec3& max) const;
  void add(const range& places);
  void number_chunks();
  bool meets_bounds(const glm::dvec3& from, const glm::dvec3& along, double& enter) const;
  std::size_t slot_of(const std::array<std::int32_t, 3>& local) const {
    return (static_cast<std::size_t>(local[2] / part) * slots_[1] + static_cast<std::size_t>(local[1] / part)) *
               slots_[0] +
           static_cast<std::size_t>(local[0] / part);
  }
  // local: counted from first_, inside of size_.
  std::uint32_t number_at(const std::array<std::int32_t, 3>& local) const {
    const std::uint32_t which = chunk_of_slot_[slot_of(local)];
    if (which == none) return none;
    const chunk& c = chunks_[which];
    const int bit = 16 * (local[2] % part) + 4 * (local[1] % part) + local[0] % part;
    if ((c.mask >> bit & 1u) == 0) return none;
    return c.first + static_cast<std::uint32_t>(std::popcount(c.mask & ((std::uint64_t{1} << bit) - 1)));
  }

  double width_;
  std::uint32_t count_ = 0;
  std::array<std::int32_t, 3> first_{}, size_{};  // of the box around all; first_ divides by `part`
  std::array<std::size_t, 3> slots_{};            // chunks along each axis of it
  std::vector<std::uint32_t> chunk_of_slot_;
  std::vector<chunk> chunks_;
  std::vector<volume_place> places_;
};

template <typename Visit>
void volume_grid::for_each_passed(const sight_line& line, double to, const Visit& visit) const {
  const glm::dvec3 from(line.eye), along(line.direction);
  double entered = 0.0;
  if (!meets_bounds(from, along, entered)) return;
  std::array<std::int32_t, 3> local{};
  std::array<double, 3> inverse{}, next{};
  const auto border = [&](std::size_t axis) {
    const auto i = static_cast<glm::length_t>(axis);
    const double place = static_cast<double>(first_[axis]) + local[axis] + (along[i] > 0.0 ? 1.0 : 0.0);
    return (place * width_ - from[i]) * inverse[axis];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<glm::length_t>(axis);
    const double place = std::floor((from[i] + along[i] * entered) / width_) - first_[axis];
    local[axis] = static_cast<std::int32_t>(std::clamp(place, 0.0, static_cast<double>(size_[axis]) - 1.0));
    inverse[axis] = 1.0 / along[i];
    next[axis] = along[i] == 0.0 ? std::numeric_limits<double>::infinity() : border(axis);
  }
  while (entered < to) {
    std::size_t axis = next[1] < next[0] ? 1 : 0;
    if (next[2] < next[axis]) axis = 2;
    if (next[axis] > entered) {
      const std::uint32_t number = number_at(local);
      if (number != none && !visit(number, entered)) return;
      entered = next[axis];
    }
    local[axis] += along[static_cast<glm::length_t>(axis)] > 0.0 ? 1 : -1;
    if (static_cast<std::uint32_t>(local[axis]) >= static_cast<std::uint32_t>(size_[axis])) return;
    next[axis] = border(axis);
  }
}

}  // namespace sightcell::bake
