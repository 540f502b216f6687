#include "volumes/volume_grid.h"

#include <fmt/format.h>

#include <glm/common.hpp>
#include <optional>

#include "cells/walkable.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr double farthest_place = 1 << 29;  // limit of the file format, with room for sums

[[noreturn]] void refuse(const std::string& cause) {
  throw error(error_kind::wrong_use, "volumes.too-many", "--volumes", cause, "give a larger width, or fewer cells");
}

struct extent {
  glm::dvec3 min{0.0}, max{0.0};
};

// Returns the space of figures whose eyes are in the cell.
extent reach_of(const view_cell& cell, double margin) {
  const double aside = std::max(margin, figure_reach);
  return {glm::dvec3(cell.min) - glm::dvec3(aside, margin + eye_height, aside),
          glm::dvec3(cell.max) + glm::dvec3(aside, margin + (figure_height - eye_height), aside)};
}

double places_in(const std::array<std::int32_t, 3>& first, const std::array<std::int32_t, 3>& last) {
  double places = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) places *= static_cast<double>(last[axis]) - first[axis] + 1.0;
  return places;
}

// Returns value rounded down to a multiple of part, also for negative values.
std::int32_t rounded_down(std::int32_t value, std::int32_t part) {
  return value - (value % part + part) % part;
}

}  // namespace

volume_grid::range volume_grid::range_of(const glm::dvec3& min, const glm::dvec3& max) const {
  range places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<glm::length_t>(axis);
    const double first = std::floor(min[i] / width_), last = std::max(std::ceil(max[i] / width_) - 1.0, first);
    if (!(first > -farthest_place && last < farthest_place))
      refuse(fmt::format("volumes of {:g} m are too small for cells {:g} m from the origin", width_,
                         std::max(std::abs(min[i]), std::abs(max[i]))));
    places.first[axis] = static_cast<std::int32_t>(first);
    places.last[axis] = static_cast<std::int32_t>(last);
  }
  return places;
}

volume_grid::volume_grid(std::span<const view_cell> cells, double width, double margin) : width_(width) {
  std::vector<range> of_cells;
  of_cells.reserve(cells.size());
  std::optional<range> all;
  for (const view_cell& cell : cells) {
    const extent reach = reach_of(cell, margin);
    const range places = range_of(reach.min, reach.max);
    if (places_in(places.first, places.last) > most_volumes)
      refuse(fmt::format("one cell has more volumes of {:g} m than the {} that a file can hold", width_, most_volumes));
    of_cells.push_back(places);
    if (!all) all = places;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all->first[axis] = std::min(all->first[axis], places.first[axis]);
      all->last[axis] = std::max(all->last[axis], places.last[axis]);
    }
  }
  if (!all) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_[axis] = rounded_down(all->first[axis], part);
    size_[axis] = rounded_down(all->last[axis], part) + part - first_[axis];
    slots_[axis] = static_cast<std::size_t>(size_[axis] / part);
  }
  if (const double places = places_in(all->first, all->last); places > static_cast<double>(most_places))
    refuse(fmt::format("with volumes of {:g} m the box around all cells has {:.0f} of them, more than {}", width_,
                       places, most_places));
  chunk_of_slot_.assign(slots_[0] * slots_[1] * slots_[2], none);
  for (const range& places : of_cells) add(places);
  number_chunks();
  if (count_ > most_volumes)
    refuse(fmt::format("the cells have {} volumes of {:g} m, more than the {} that a file can hold", count_, width_,
                       most_volumes));
}

void volume_grid::add(const range& places) {
  std::array<std::int32_t, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = places.first[axis] - first_[axis];
    high[axis] = places.last[axis] - first_[axis];
  }
  std::array<std::int32_t, 3> at{};
  for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) {
        std::uint32_t& which = chunk_of_slot_[slot_of(at)];
        if (which == none) {
          which = static_cast<std::uint32_t>(chunks_.size());
          chunks_.emplace_back();
        }
        chunks_[which].mask |= std::uint64_t{1} << (16 * (at[2] % part) + 4 * (at[1] % part) + at[0] % part);
      }
  // Checked here, before the chunks take all memory.
  if (chunks_.size() > most_volumes)
    refuse(fmt::format("the cells have more volumes of {:g} m than the {} that a file can hold", width_, most_volumes));
}

// Numbers volumes by the position of their chunks, and not by the order of the cells.
void volume_grid::number_chunks() {
  std::vector<chunk> sorted;
  sorted.reserve(chunks_.size());
  for (std::size_t slot = 0; slot < chunk_of_slot_.size(); ++slot) {
    std::uint32_t& which = chunk_of_slot_[slot];
    if (which == none) continue;
    const std::uint64_t mask = chunks_[which].mask;
    which = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back({mask, count_});
    count_ += static_cast<std::uint32_t>(std::popcount(mask));
    if (count_ > most_volumes) return;  // the constructor rejects them
    const auto place = [&](std::size_t axis, std::size_t number, int bit) {
      return first_[axis] + part * static_cast<std::int32_t>(number) + bit;
    };
    for (std::uint64_t left = mask; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      places_.push_back({place(0, slot % slots_[0], bit % 4), place(1, slot / slots_[0] % slots_[1], bit / 4 % 4),
                         place(2, slot / slots_[0] / slots_[1], bit / 16)});
    }
  }
  chunks_ = std::move(sorted);
}

box volume_grid::box_of(std::uint32_t number) const {
  const glm::dvec3 at(places_[number].x, places_[number].y, places_[number].z);
  return {glm::vec3(at * width_), glm::vec3((at + 1.0) * width_)};
}

std::uint32_t volume_grid::at(const volume_place& place) const {
  const std::array<std::int32_t, 3> local{place.x - first_[0], place.y - first_[1], place.z - first_[2]};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (static_cast<std::uint32_t>(local[axis]) >= static_cast<std::uint32_t>(size_[axis])) return none;
  return number_at(local);
}

std::vector<std::uint32_t> volume_grid::touching(const box& where) const {
  std::vector<std::uint32_t> found;
  if (count_ == 0) return found;
  std::array<std::int32_t, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<glm::length_t>(axis);
    // A border belongs to the volumes on both sides.
    const double first = std::ceil(double{where.min[i]} / width_) - 1.0 - first_[axis];
    const double last = std::floor(double{where.max[i]} / width_) - first_[axis];
    if (!(last >= 0.0 && first < static_cast<double>(size_[axis]))) return found;
    low[axis] = static_cast<std::int32_t>(std::max(first, 0.0));
    high[axis] = static_cast<std::int32_t>(std::min(last, static_cast<double>(size_[axis]) - 1.0));
  }
  std::array<std::int32_t, 3> at{};
  for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
        if (const std::uint32_t number = number_at(at); number != none) found.push_back(number);
  std::sort(found.begin(), found.end());
  return found;
}

bool volume_grid::meets_bounds(const glm::dvec3& from, const glm::dvec3& along, double& enter) const {
  if (count_ == 0) return false;
  double leave = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<glm::length_t>(axis);
    const double low = static_cast<double>(first_[axis]) * width_,
                 high = (static_cast<double>(first_[axis]) + size_[axis]) * width_;
    if (along[i] == 0.0) {
      if (from[i] < low || from[i] >= high) return false;
      continue;
    }
    const double a = (low - from[i]) / along[i], b = (high - from[i]) / along[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

}  // namespace sightcell::bake
