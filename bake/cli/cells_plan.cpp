#include "cells_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "number_text.h"
#include "sightcell/picture/floor_plan.h"

namespace sightcell::cli {
namespace {

constexpr std::size_t most_keys = 5;

picture::plan_rectangle rectangle_of(const bake::cell_box& cell) {
  return {cell.min[0], cell.min[2], cell.max[0], cell.max[2]};
}

picture::plan_rectangle frame_of(std::span<const bake::cell_box> cells) {
  picture::plan_rectangle frame = rectangle_of(cells.front());
  for (const bake::cell_box& cell : cells)
    frame = {std::min(frame.min_x, cell.min[0]), std::min(frame.min_z, cell.min[2]), std::max(frame.max_x, cell.max[0]),
             std::max(frame.max_z, cell.max[2])};
  return frame;
}

long width_of(const bake::cell_box& cell) {  // millimeters
  return std::lround(1000.0 * static_cast<double>(std::max(cell.max[0] - cell.min[0], cell.max[2] - cell.min[2])));
}

// By width: a number from 0 for the narrowest to 1 for the widest cells.
std::map<long, float> colors_of(std::span<const bake::cell_box> cells) {
  std::map<long, float> colors;
  for (const bake::cell_box& cell : cells) colors[width_of(cell)] = 0.0f;
  std::size_t number = 0;
  for (auto& [width, color] : colors)
    color = colors.size() > 1 ? static_cast<float>(number++) / static_cast<float>(colors.size() - 1) : 0.0f;
  return colors;
}

std::vector<picture::plan_key> legend_of(const std::map<long, float>& colors) {
  std::vector<picture::plan_key> legend;
  std::size_t number = 0, named = 0;
  for (const auto& [width, color] : colors) {
    // Of many widths some that are spread evenly, with the first and the last.
    if (colors.size() <= most_keys || number * (most_keys - 1) >= named * (colors.size() - 1)) {
      legend.push_back({color, fmt::format("{:g} m", static_cast<double>(width) / 1000.0)});
      ++named;
    }
    ++number;
  }
  return legend;
}

// Returns the number of the floor on which a start is: that with a cell there whose ground is nearest.
std::size_t floor_of(const std::array<float, 3>& start, const bake::cell_preview& preview) {
  constexpr double far = 1e6;  // more than any difference of height, per meter beside a cell
  std::size_t best = 0;
  double least = INFINITY;
  for (std::size_t floor = 0; floor < preview.floors.size(); ++floor)
    for (const std::uint32_t cell : preview.floors[floor].cells) {
      const bake::cell_box& box = preview.cells[cell];
      double beside = 0.0;
      for (const std::size_t axis : {std::size_t{0}, std::size_t{2}})
        beside += static_cast<double>(std::max({box.min[axis] - start[axis], start[axis] - box.max[axis], 0.0f}));
      const double distance = far * beside + std::abs(static_cast<double>(start[1]) - preview.ground[cell]);
      if (distance < least) {
        least = distance;
        best = floor;
      }
    }
  return best;
}

std::string heights_text(const bake::cell_floor& floor) {
  const std::string low = fmt::format("{:.1f}", floor.lowest), high = fmt::format("{:.1f}", floor.highest);
  return low == high ? low + " m" : fmt::format("{} to {} m", low, high);
}

}  // namespace

std::vector<std::filesystem::path> write_cells_plan(const bake::cell_preview& preview,
                                                    const scene::world_geometry& geometry,
                                                    std::span<const std::array<float, 3>> starts,
                                                    const std::string& prefix) {
  std::vector<std::filesystem::path> written;
  if (preview.cells.empty()) return written;
  const std::map<long, float> colors = colors_of(preview.cells);
  std::vector<picture::floor_plan> plans(preview.floors.size());
  for (const std::array<float, 3>& start : starts)
    plans[floor_of(start, preview)].marks.push_back({start[0], start[2]});
  for (std::size_t number = 0; number < plans.size(); ++number) {
    const bake::cell_floor& floor = preview.floors[number];
    picture::floor_plan& plan = plans[number];
    plan.frame = frame_of(preview.cells);
    plan.legend = legend_of(colors);
    for (const std::uint32_t cell : floor.cells)
      plan.areas.push_back({rectangle_of(preview.cells[cell]), static_cast<float>(preview.ground[cell]),
                            colors.at(width_of(preview.cells[cell]))});
    plan.title = fmt::format("Floor {} of {}: {}, {} cells. Right is +x, up is -z.", number + 1, plans.size(),
                             heights_text(floor), grouped(floor.cells.size()));
    written.emplace_back(fmt::format("{}-{}.png", prefix, number + 1));
    picture::write_png(written.back(), picture::draw_floor_plan(geometry, plan));
  }
  return written;
}

}  // namespace sightcell::cli
