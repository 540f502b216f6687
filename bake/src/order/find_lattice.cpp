#include "order/find_lattice.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "sightcell/base/json_text.h"
#include "sightcell/format/cell_lattice.h"
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
    const double at = std::round(static_cast<double>(b.min[axis]) / size[axis]);
    if (!(std::abs(at) < 1 << 30)) return std::nullopt;
    *out[axis] = static_cast<std::int32_t>(at);
  }
  const format::box exact = format::box_of(shape, place);
  if (exact.min != b.min || exact.max != b.max) return std::nullopt;
  return place;
}

}  // namespace

std::optional<cells_on_lattice> find_lattice(std::span<const format::box> cells, std::string_view settings) {
  const double cell_size = cell_size_of(settings);
  if (!(cell_size > 0.0) || cells.empty()) return std::nullopt;
  // Level 0 is that of the widest cells. All cells are equally high: more than half the cell size where the lattice was
  // made coarser for a large scene.
  const auto narrower = [](const format::box& a, const format::box& b) { return width_of(a) < width_of(b); };
  const auto [narrowest, widest] = std::minmax_element(cells.begin(), cells.end(), narrower);
  const double height = static_cast<double>(widest->max[1]) - static_cast<double>(widest->min[1]);
  const double low = doublings(width_of(*narrowest), cell_size), high = doublings(width_of(*widest), cell_size);
  cells_on_lattice found;
  found.shape = {cell_size * std::exp2(high), cell_size * std::exp2(doublings(2.0 * height, cell_size)) / 2.0,
                 high > low};
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

}  // namespace sightcell::bake
