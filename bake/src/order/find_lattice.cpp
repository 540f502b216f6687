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

// Returns the lattice position of a box, nothing if the box is not a lattice cell.
std::optional<format::lattice_place> place_of(const format::box& b, const format::lattice_shape& shape) {
  format::lattice_place place;
  const std::array<double, 3> size{shape.width, shape.height, shape.width};
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
  const format::box& any = cells.front();
  const double coarser = std::exp2(std::round(std::log2((any.max[0] - any.min[0]) / cell_size)));
  cells_on_lattice found;
  found.shape = {cell_size * coarser, cell_size * coarser / 2.0};
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
