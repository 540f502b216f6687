#include "cells/floor_cells.h"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

namespace sightcell::bake {
namespace {

bool by_position(const floor_cell& a, const floor_cell& b) {
  return a.position < b.position;
}

// Returns the median height of the floors of a cell. floors: heights and areas.
double median_of(std::vector<std::pair<double, double>>& floors, double area) {
  std::sort(floors.begin(), floors.end());
  double below = 0.0;
  for (const auto& [height, part] : floors)
    if (below += part; 2.0 * below >= area) return height;
  return floors.empty() ? 0.0 : floors.back().first;
}

// Adds the cells of eyes that overlap each other.
void add_cut(std::span<const eye_layers> eyes, std::int64_t first, std::int64_t end, const lattice_position& column,
             std::vector<floor_cell>& cells) {
  const std::int64_t height = end - first, highest = std::int64_t{lattice::layers_per_width} << column.level;
  const std::int64_t parts = (height + highest - 1) / highest;
  std::vector<std::pair<double, double>> floors;
  for (std::int64_t part = 0; part < parts; ++part) {
    floors.clear();
    const std::int64_t low = first + height * part / parts, high = first + height * (part + 1) / parts;
    floor_cell cell{column};
    cell.position.y = low;
    cell.position.layers = static_cast<std::int32_t>(high - low);
    for (const eye_layers& some : eyes) {
      const std::int64_t inside = std::min(some.end, high) - std::max(some.first, low);
      if (inside <= 0) continue;
      const double area = some.area * static_cast<double>(inside) / static_cast<double>(some.end - some.first);
      cell.area += area;
      floors.emplace_back(some.floor, area);
    }
    cell.floor = median_of(floors, cell.area);
    cells.push_back(cell);
  }
}

}  // namespace

void add_floor_cells(std::vector<eye_layers>& eyes, const lattice_position& column, std::vector<floor_cell>& cells) {
  std::sort(eyes.begin(), eyes.end(), [](const eye_layers& a, const eye_layers& b) {
    return std::tie(a.first, a.end, a.area, a.floor) < std::tie(b.first, b.end, b.area, b.floor);
  });
  for (std::size_t begin = 0; begin < eyes.size();) {
    std::int64_t end = eyes[begin].end;
    std::size_t next = begin + 1;
    for (; next < eyes.size() && eyes[next].first < end; ++next) end = std::max(end, eyes[next].end);
    add_cut(std::span(eyes).subspan(begin, next - begin), eyes[begin].first, end, column, cells);
    begin = next;
  }
}

lattice widen_until(std::vector<floor_cell>& cells, lattice on, std::size_t most) {
  while (cells.size() > most) {
    const auto column_of = [](const floor_cell& cell) {
      return lattice_position{.z = cell.position.z >> 1, .y = 0, .x = cell.position.x >> 1};
    };
    std::stable_sort(cells.begin(), cells.end(),
                     [&](const floor_cell& a, const floor_cell& b) { return column_of(a) < column_of(b); });
    std::vector<floor_cell> wider;
    std::vector<eye_layers> eyes;
    for (std::size_t i = 0; i < cells.size();) {
      const lattice_position column = column_of(cells[i]);
      eyes.clear();
      for (; i < cells.size() && column_of(cells[i]) == column; ++i) {
        const lattice_position& at = cells[i].position;
        eyes.push_back({at.y >> 1, (at.y + at.layers + 1) >> 1, cells[i].area, cells[i].floor});
      }
      add_floor_cells(eyes, column, wider);
    }
    std::sort(wider.begin(), wider.end(), by_position);
    cells = std::move(wider);
    on = on.coarser();
  }
  return on;
}

}  // namespace sightcell::bake
