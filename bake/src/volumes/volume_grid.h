#pragma once
// Visibility volumes: cubes of a coarse lattice in which movable things can be. Each is an item of cell sets, with a
// number behind that of the last polygon. It is visible if a line from the cell passes it before an occluder blocks the
// line.
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

// Meters: the height of a figure on the floor below an eye, and its least reach to the sides.
inline constexpr double figure_height = 2.0, figure_reach = 0.5;

// The lattice position of a volume. Its lower corner is this times the width of the lattice.
struct volume_place {
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const volume_place&) const = default;
};

class volume_grid {
 public:
  // Limits: volumes of a scene, and lattice positions in the box around them.
  static constexpr std::uint32_t most_volumes = 1u << 24;
  static constexpr std::uint64_t most_places = std::uint64_t{1} << 32;
  static constexpr std::uint32_t none = 0xFFFFFFFFu;

  // Makes the volumes of the cells of a bake: the cubes of a lattice anchored at the world origin that share volume
  // with the space of a figure whose eye is in one of the cells. That space is the box of the cell, grown by margin, by
  // at least figure_reach to the sides, down to the floor below its lowest eye and up to the head above its highest.
  // width: of a cube in meters.
  // margin: in meters.
  // Throws sightcell::error "volumes.too-many".
  volume_grid(std::span<const view_cell> cells, double width, double margin);

  double width() const { return width_; }
  std::uint32_t count() const { return count_; }
  // Returns the lattice positions by volume number. Numbers depend on the positions alone.
  const std::vector<volume_place>& places() const { return places_; }
  box box_of(std::uint32_t number) const;
  // Returns the number of the volume at a lattice position, or none.
  std::uint32_t at(const volume_place& place) const;
  // Returns the volumes that share a point with a box, ascending.
  std::vector<std::uint32_t> touching(const box& where) const;

  // Calls visit(number, distance) for all volumes that a line passes before distance `to`, the nearest first, until it
  // returns false (Amanatides and Woo 1987). distance is where the line enters the volume.
  // A volume contains its lower borders and not its upper ones. A volume that the line only touches is not passed.
  // Computed in double precision, each border from its own number, so that no error adds up along the line.
  template <typename Visit>
  void for_each_passed(const sight_line& line, double to, const Visit& visit) const;

 private:
  static constexpr std::int32_t part = 4;  // lattice positions of a chunk along each axis
  struct chunk {
    std::uint64_t mask = 0;   // bit 16 z + 4 y + x
    std::uint32_t first = 0;  // volume number of its first position
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
  // local: relative to first_, inside of size_.
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
  std::array<std::int32_t, 3> first_{}, size_{};  // box around all volumes; first_ is a multiple of `part`
  std::array<std::size_t, 3> slots_{};            // chunks along each axis of that box
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
