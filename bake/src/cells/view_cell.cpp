#include "cells/view_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "cells/cells_file.h"
#include "cells/explicit_cells.h"
#include "cells/flight.h"
#include "cells/lattice.h"
#include "cells/walkable.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {

namespace {

constexpr std::size_t asked_limit = 1'000'000;  // for --cells-grid
constexpr double border = 2.0;                  // meters around the scene if no floor is found

std::vector<lattice_position> positions_of(const lattice_range& range) {
  std::vector<lattice_position> positions;
  positions.reserve(static_cast<std::size_t>(range.count()));
  for (std::int64_t z = range.first.z; z <= range.last.z; ++z)
    for (std::int64_t y = range.first.y; y <= range.last.y; ++y)
      for (std::int64_t x = range.first.x; x <= range.last.x; ++x) positions.push_back({.z = z, .y = y, .x = x});
  return positions;
}

void add_cells(const std::vector<lattice_position>& positions, const lattice& on, cell_list& list) {
  list.cells.reserve(positions.size());
  for (const lattice_position& p : positions) list.cells.push_back(on.cell(p));
}

cell_list cells_of_grid(const std::array<float, 6>& box, double cell_size) {
  const lattice on(cell_size);
  const lattice_range range = on.overlapping({box[0], box[1], box[2]}, {box[3], box[4], box[5]});
  if (range.count() > static_cast<double>(asked_limit))
    throw error(error_kind::wrong_use, "cells.too-many", "--cells-grid",
                fmt::format("{:.0f} cells, more than {}", range.count(), asked_limit),
                "use a larger --cell-size or a smaller box");
  cell_list list;
  add_cells(positions_of(range), on, list);
  list.how = fmt::format("{} cells of {:g} m in a grid", list.cells.size(), on.width());
  return list;
}

// Unites the cells over floors with those of flight, and makes boxes of them. A cell over a floor that is inside of one
// of flight is left out. One of flight counts as one with floor below all of it: a camera is there as often.
// on: over_floors(). flight: positions on a lattice of that width whose layers are half as high as wide.
void add_united(const std::vector<floor_cell>& floors, const std::vector<lattice_position>& flight, const lattice& on,
                cell_list& list) {
  constexpr std::int32_t height = lattice::layers_per_width / 2;
  std::map<lattice_position, floor_cell> cells;
  for (lattice_position position : flight) {
    position.y *= height, position.layers = height;
    cells[position] = {position, on.width() * on.width(), static_cast<double>(on.cell(position).min.y)};
  }
  const auto flies_at = [&](lattice_position at, std::int64_t layer) {
    at.y = layer - (layer % height + height) % height, at.layers = height;
    return cells.contains(at);
  };
  std::vector<floor_cell> kept;
  for (const floor_cell& cell : floors) {
    bool inside = !flight.empty();
    for (std::int32_t i = 0; i < cell.position.layers && inside; ++i)
      inside = flies_at(cell.position, cell.position.y + i);
    if (!inside) kept.push_back(cell);
  }
  for (const floor_cell& cell : kept) cells.emplace(cell.position, cell);
  list.cells.reserve(cells.size());
  for (const auto& [position, cell] : cells) {
    list.cells.push_back(on.cell(position));
    list.cells.back().floor_area = cell.area;
    list.cells.back().floor = cell.floor;
  }
  list.can_merge = true;
  list.cell_width = on.width();
}

void warn_of_width(double cells, const lattice& before, const lattice& now, std::uint32_t most, cell_list& list) {
  if (now.width() > before.width())
    list.warnings.push_back(
        fmt::format("{:.0f} cells of {:g} m would be more than --most-cells {}: the smallest cells are {:g} m wide",
                    cells, before.width(), most, now.width()));
}

// Fills the bounding box with cells, made larger until there are at most `most`.
// Returns their lattice.
lattice fill_bounds(const scene::world_geometry& geometry, const lattice& asked, std::uint32_t most, cell_list& list) {
  list.warnings.push_back("no floor with head room was found: cells fill the bounding box");
  list.where = "in a grid over the bounding box";
  const glm::dvec3 min = glm::dvec3(geometry.min) - border, max = glm::dvec3(geometry.max) + border;
  lattice on = asked;
  lattice_range range = on.overlapping(min, max);
  const double before = range.count();
  while (range.count() > static_cast<double>(most)) {
    on = on.coarser();
    range = on.overlapping(min, max);
  }
  add_cells(positions_of(range), on, list);
  warn_of_width(before, asked, on, most, list);
  return on;
}

cell_list automatic_cells(const scene::world_geometry& geometry, const settings& how, const stop_request* stop) {
  const lattice asked = lattice::over_floors(static_cast<double>(how.cell_size));
  walkable_cells walkable;
  walkable.on = asked;
  if (how.reach != reach_kind::none) walkable = find_walkable_cells(geometry, asked, how, stop);
  cell_list list;
  list.warnings = std::move(walkable.warnings);
  const auto before = static_cast<double>(walkable.cells.size());
  if (!walkable.cells.empty()) list.where = "over floors " + walkable.how;
  lattice on = widen_until(walkable.cells, walkable.on, how.most_cells);
  warn_of_width(before, walkable.on, on, how.most_cells, list);
  if (flies(how)) {
    if (walkable.cells.empty() && how.reach != reach_kind::none)
      list.warnings.push_back("no floor with head room was found");
    const flight_cells flight = find_flight_cells(geometry, lattice(on.width()), how);
    list.where += (list.where.empty() ? "" : ", ") + flight.how;
    list.warnings.insert(list.warnings.end(), flight.warnings.begin(), flight.warnings.end());
    add_united(walkable.cells, flight.cells, on, list);
  } else if (!walkable.cells.empty()) {
    add_united(walkable.cells, {}, on, list);
  } else {
    on = fill_bounds(geometry, lattice(asked.width()), how.most_cells, list);
  }
  list.how = fmt::format("{} cells of {:g} m {}", list.cells.size(), on.width(), list.where);
  return list;
}

// Returns the boxes that the scene contains as cells.
cell_list cells_of_scene(const scene::world_geometry& geometry) {
  std::vector<cell_box> boxes;
  for (const scene::marked_cell& cell : geometry.cells) boxes.push_back({cell.name, cell.min, cell.max});
  cell_list list;
  list.cells = explicit_cells(boxes, "extras.sightcell.cell", "give the node a box with a volume, near the origin");
  list.how = fmt::format("{} cells of the scene (extras.sightcell.cell), instead of cells over floors", boxes.size());
  list.of_scene = true;
  return list;
}

}  // namespace

float distance_of(const view_cell& cell, const std::array<float, 3>& point) {
  const glm::vec3 at{point[0], point[1], point[2]};
  return glm::distance(at, glm::clamp(at, cell.min, cell.max));
}

void limit_cells(cell_list& list, std::uint32_t limit, const std::optional<std::array<float, 3>>& near) {
  const std::size_t all = list.cells.size();
  if (limit == 0 || limit >= all) return;
  std::vector<std::size_t> kept(limit);
  if (near) {
    std::vector<std::pair<float, std::size_t>> by_distance;
    for (std::size_t i = 0; i < all; ++i) by_distance.emplace_back(distance_of(list.cells[i], *near), i);
    std::sort(by_distance.begin(), by_distance.end());
    for (std::size_t i = 0; i < limit; ++i) kept[i] = by_distance[i].second;
    std::sort(kept.begin(), kept.end());
  } else {
    // The middle cell of each of `limit` equal parts of the list.
    for (std::size_t i = 0; i < limit; ++i) kept[i] = (2 * i + 1) * all / (2 * std::size_t{limit});
  }
  std::vector<view_cell> chosen;
  chosen.reserve(limit);
  for (const std::size_t i : kept) chosen.push_back(std::move(list.cells[i]));
  list.cells = std::move(chosen);
  list.how = fmt::format("{} {}of ", limit, near ? "nearest " : "") + list.how;
}

cell_list make_all_cells(const scene::world_geometry& geometry, const settings& how, const stop_request* stop) {
  cell_list list;
  if (!how.cells.empty()) {
    list.cells = explicit_cells(how.cells, "settings.cells", "give meters, min below max on every axis");
    list.how = fmt::format("{} cells given", list.cells.size());
  } else if (how.cells_file) {
    list.cells = read_cells_file(*how.cells_file);
    list.how = fmt::format("{} cells from {}", list.cells.size(), how.cells_file->filename().string());
  } else if (how.cells_grid) {
    list = cells_of_grid(*how.cells_grid, static_cast<double>(how.cell_size));
  } else if (!geometry.cells.empty() && !flies(how)) {
    list = cells_of_scene(geometry);
  } else {
    list = automatic_cells(geometry, how, stop);
    if (!geometry.cells.empty())
      list.warnings.push_back(
          fmt::format("{} cells of the scene (extras.sightcell.cell) are left out, because --fly or a path is given",
                      geometry.cells.size()));
  }
  return list;
}

cell_list make_cells(const scene::world_geometry& geometry, const settings& how) {
  cell_list list = make_all_cells(geometry, how);
  limit_cells(list, how.cell_limit, how.near);
  return list;
}

}  // namespace sightcell::bake
