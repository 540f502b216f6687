#include "cells/lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>

#include "sightcell/base/error.h"

namespace sightcell::bake {

namespace {

// Beyond this, adjacent lattice planes have the same single-precision coordinate in a file.
constexpr double index_limit = 1 << 30;

[[noreturn]] void refuse_distance(double where) {
  throw error(error_kind::bad_input, "cells.too-far", "view cells",
              fmt::format("a cell at {:g} m cannot be distinguished from its neighbor in single precision", where),
              "move the scene toward the origin or use a larger --cell-size");
}

std::int64_t index_of(double where, double size) {
  const double index = std::floor(where / size);
  if (!(std::abs(index) < index_limit)) refuse_distance(where);
  return static_cast<std::int64_t>(index);
}

std::int64_t last_index_of(double where, double size) {
  const double index = std::ceil(where / size) - 1.0;
  if (!(std::abs(index) < index_limit)) refuse_distance(where);
  return static_cast<std::int64_t>(index);
}

}  // namespace

double lattice_range::count() const {
  return static_cast<double>(last.x - first.x + 1) * static_cast<double>(last.y - first.y + 1) *
         static_cast<double>(last.z - first.z + 1);
}

lattice_range lattice::overlapping(const glm::dvec3& min, const glm::dvec3& max) const {
  lattice_range range;
  range.first = {.z = index_of(min.z, width_), .y = index_of(min.y, height_), .x = index_of(min.x, width_)};
  range.last = {.z = std::max(range.first.z, last_index_of(max.z, width_)),
                .y = std::max(range.first.y, last_index_of(max.y, height_)),
                .x = std::max(range.first.x, last_index_of(max.x, width_))};
  return range;
}

void lattice::set_box(const lattice_position& p, view_cell& cell) const {
  const double width = std::ldexp(width_, p.level);
  const auto corner = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    return glm::vec3(static_cast<float>(static_cast<double>(x) * width),
                     static_cast<float>(static_cast<double>(y) * height_),
                     static_cast<float>(static_cast<double>(z) * width));
  };
  cell.min = corner(p.x, p.y, p.z);
  cell.max = corner(p.x + 1, p.y + p.layers, p.z + 1);
}

bool lattice::has_volume(const lattice_position& p) const {
  view_cell made;
  set_box(p, made);
  return glm::all(glm::lessThan(made.min, made.max));
}

view_cell lattice::cell(const lattice_position& p) const {
  view_cell made;
  set_box(p, made);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(made.min[axis] < made.max[axis])) refuse_distance(static_cast<double>(made.min[axis]));
  }
  made.place = mix(mix(mix(0, static_cast<std::uint64_t>(p.x)), static_cast<std::uint64_t>(p.y)),
                   static_cast<std::uint64_t>(p.z));
  if (p.level > 0) made.place = mix(made.place, static_cast<std::uint64_t>(p.level));
  if (p.layers != 1) made.place = mix(made.place, static_cast<std::uint64_t>(p.layers));
  made.floor = static_cast<double>(made.min.y);
  made.on_lattice = true;
  made.position = p;
  return made;
}

std::uint64_t mix(std::uint64_t state, std::uint64_t value) {
  // The finalizer of SplitMix64 over a running sum: every bit of value affects every bit of the result.
  std::uint64_t z = state + value + 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace sightcell::bake
