#include "order/find_lattice.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "cells/lattice.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/grid_boxes.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
namespace {

// Returns the cell size of the lattice on which the cells were made, before it was coarsened; 0 if they were not made
// on a lattice.
double cell_size_of(std::string_view settings) {
  const auto text = scene::parse_json(settings, false);
  if (!text.is_object()) return 0.0;
  const std::string kind = text.contains("cells") && text["cells"].is_string() ? text["cells"] : "";
  const bool made = kind == "automatic" || kind == "grid";
  if (!made || !text.contains("cell_size") || !text["cell_size"].is_number()) return 0.0;
  return static_cast<double>(text["cell_size"].get<float>());  // settings store a float
}

double width_of(const format::box& b) {
  return static_cast<double>(b.max[0]) - static_cast<double>(b.min[0]);
}

// Returns the power of 2 by which a size is nearest to cell_size.
double doublings(double size, double cell_size) {
  return std::round(std::log2(size / cell_size));
}

// Returns the number of a border, nothing if it is too far from 0 for a lattice and for a grid.
std::optional<std::int32_t> border_of(float at, double size) {
  const double number = std::round(static_cast<double>(at) / size);
  if (!(std::abs(number) < 1 << 30)) return std::nullopt;
  return static_cast<std::int32_t>(number);
}

// Returns the lattice position of a box, nothing if the box is not a lattice cell.
std::optional<format::lattice_place> place_of(const format::box& b, const format::lattice_shape& shape) {
  const double level = -doublings(width_of(b), shape.width);
  if (!(level >= 0.0 && level <= format::max_lattice_level)) return std::nullopt;
  format::lattice_place place;
  place.level = static_cast<std::uint32_t>(level);
  const double width = shape.width_of(place.level);
  const std::array<double, 3> size{width, shape.height_of(place.level), width};
  const std::array<std::int32_t*, 3> out{&place.x, &place.y, &place.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<std::int32_t> at = border_of(b.min[axis], size[axis]);
    if (!at) return std::nullopt;
    *out[axis] = *at;
  }
  const format::box exact = format::box_of(shape, place);
  if (exact.min != b.min || exact.max != b.max) return std::nullopt;
  return place;
}

// Returns the place of a box on a grid, nothing if the box is not of whole steps.
std::optional<format::grid_box> place_on_grid(const format::box& b, const format::lattice_shape& step) {
  const std::array<double, 3> size{step.width, step.height, step.width};
  std::array<std::int32_t, 3> first{}, count{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<std::int32_t> begin = border_of(b.min[axis], size[axis]);
    const std::optional<std::int32_t> end = border_of(b.max[axis], size[axis]);
    if (!begin || !end || !(*begin < *end)) return std::nullopt;
    first[axis] = *begin;
    count[axis] = *end - *begin;
  }
  const auto steps = [&](std::size_t axis) { return static_cast<std::uint32_t>(count[axis]); };
  const format::grid_box place{first[0], first[1], first[2], steps(0), steps(1), steps(2)};
  const format::box exact = format::box_of(step, place);
  if (exact.min != b.min || exact.max != b.max) return std::nullopt;
  return place;
}

std::optional<std::vector<format::grid_box>> places_on_grid(std::span<const format::box> cells,
                                                            const format::lattice_shape& step) {
  std::vector<format::grid_box> places;
  for (const format::box& b : cells) {
    const std::optional<format::grid_box> place = place_on_grid(b, step);
    if (!place) return std::nullopt;
    places.push_back(*place);
  }
  return places;
}

bool is_narrower(const format::box& a, const format::box& b) {
  return width_of(a) < width_of(b);
}

}  // namespace

std::optional<cells_on_lattice> find_lattice(std::span<const format::box> cells, std::string_view settings) {
  const double cell_size = cell_size_of(settings);
  if (!(cell_size > 0.0) || cells.empty()) return std::nullopt;
  // Level 0 is that of the widest cells, whose width is more than the cell size where the lattice was made coarser for
  // a large scene.
  const format::box& widest = *std::max_element(cells.begin(), cells.end(), is_narrower);
  const double height = static_cast<double>(widest.max[1]) - static_cast<double>(widest.min[1]);
  cells_on_lattice found;
  found.shape = {cell_size * std::exp2(doublings(width_of(widest), cell_size)),
                 cell_size * std::exp2(doublings(2.0 * height, cell_size)) / 2.0};
  std::vector<format::lattice_place> places;
  for (const format::box& b : cells) {
    const std::optional<format::lattice_place> place = place_of(b, found.shape);
    if (!place) return std::nullopt;
    places.push_back(*place);
  }
  found.cells.resize(cells.size());
  std::iota(found.cells.begin(), found.cells.end(), 0u);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return format::lattice_comes_before(places[a], places[b]);
  };
  std::sort(found.cells.begin(), found.cells.end(), before);
  if (std::adjacent_find(found.cells.begin(), found.cells.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return !before(a, b); }) != found.cells.end())
    return std::nullopt;  // two cells at the same position
  for (const std::uint32_t cell : found.cells) found.places.push_back(places[cell]);
  return found;
}

std::optional<cells_on_grid> find_grid(std::span<const format::box> cells, std::string_view settings) {
  const double cell_size = cell_size_of(settings);
  if (!(cell_size > 0.0) || cells.empty()) return std::nullopt;
  const format::box& narrowest = *std::min_element(cells.begin(), cells.end(), is_narrower);
  const double width = cell_size * std::exp2(doublings(width_of(narrowest), cell_size));
  if (!std::isfinite(width)) return std::nullopt;
  // Where all cells were merged, layers are lower than those of cells of this width.
  for (double lattice_width = width; lattice_width >= cell_size; lattice_width /= 2.0) {
    const format::lattice_shape step{width, lattice_width / lattice::layers_per_width};
    if (auto places = places_on_grid(cells, step)) return cells_on_grid{step, std::move(*places)};
  }
  return std::nullopt;
}

}  // namespace sightcell::bake
