#include "cells/walkable.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "cells/floor_cells.h"
#include "cells/reach.h"
#include "cells/voxel_field.h"

namespace sightcell::bake {
namespace {

constexpr double fine_voxel = 0.25;       // meters: the width of a person
constexpr double coarse_voxel = 0.5;      // meters: the widest that keeps doors and alleys open
constexpr double column_limit = 4 << 20;  // columns of the field: 32 MB of pointers, plus the spans
// A floor without a way from the one with the most polygons around it gets cells if it has this share of them.
constexpr double share_of_richest = 0.015, smallest_floor = 20.0;  // of polygons; square meters

std::optional<field_bounds> bounds_of_obstacles(const scene::world_geometry& geometry) {
  std::optional<field_bounds> found;
  for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
    if (!is_obstacle(geometry.kinds[p])) continue;
    for (const glm::dvec3& at : double_corners(geometry, p)) {
      if (!found) found = field_bounds{at, at};
      found->min = glm::min(found->min, at);
      found->max = glm::max(found->max, at);
    }
  }
  return found;
}

// Returns the bounds of most polygons: at each end of each axis a share `cut` of their centers is left out. A few
// polygons of a sky dome or of a distant terrain must not make the voxels of a level coarse.
field_bounds bounds_of_middle(const scene::world_geometry& geometry, double cut) {
  field_bounds middle;
  std::vector<double> centers;
  for (int axis = 0; axis < 3; ++axis) {
    centers.clear();
    for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
      if (!is_obstacle(geometry.kinds[p])) continue;
      const auto at = double_corners(geometry, p);
      centers.push_back((at[0][axis] + at[1][axis] + at[2][axis]) / 3.0);
    }
    const auto low = static_cast<std::size_t>(cut * static_cast<double>(centers.size()));
    const std::size_t high = centers.size() - 1 - low;
    const auto nth = [&centers](std::size_t n) {
      std::nth_element(centers.begin(), centers.begin() + static_cast<std::ptrdiff_t>(n), centers.end());
      return centers[n];
    };
    middle.min[axis] = nth(low) - 2.0 * eye_height;
    middle.max[axis] = nth(high) + 2.0 * eye_height;
  }
  return middle;
}

double columns_at(const field_bounds& world, double voxel) {
  const glm::dvec3 extent = world.max - world.min;
  return (extent.x / voxel + 1.0) * (extent.z / voxel + 1.0);
}

// Returns the largest number of voxels along a cell that the column limit allows for this part of the world; 0 if not
// even one fits.
int fitting_voxels_per_cell(const field_bounds& world, double cell) {
  // The field is snapped to the lattice, which adds up to a cell at each border.
  const field_bounds snapped{world.min - cell, world.max + cell};
  // 4096 gives voxels below a quarter of a meter for every permitted cell size.
  auto voxels = static_cast<int>(std::min(std::ceil(cell / fine_voxel), 4096.0));
  while (voxels > 0 && columns_at(snapped, cell / voxels) > column_limit) --voxels;
  return voxels;
}

field_shape shape_of(const field_bounds& world, const lattice& on, int voxels_per_cell) {
  field_shape shape;
  shape.world = world;
  shape.on = on;
  shape.voxels_per_cell = voxels_per_cell;
  shape.voxel = on.width() / voxels_per_cell;
  shape.step = std::max(fine_step, (world.max.y - world.min.y) / (highest_voxel - 8));
  shape.cells = on.overlapping(world.min, world.max);
  shape.width = static_cast<int>(shape.cells.last.x - shape.cells.first.x + 1) * voxels_per_cell;
  shape.depth = static_cast<int>(shape.cells.last.z - shape.cells.first.z + 1) * voxels_per_cell;
  shape.world.min.x = static_cast<double>(shape.cells.first.x) * on.width();
  shape.world.min.z = static_cast<double>(shape.cells.first.z) * on.width();
  shape.world.max.x = static_cast<double>(shape.cells.last.x + 1) * on.width();
  shape.world.max.z = static_cast<double>(shape.cells.last.z + 1) * on.width();
  shape.world.min.y = (std::floor(world.min.y / shape.step) - 1.0) * shape.step;
  shape.world.max.y = world.max.y + 2.0 * shape.step;
  return shape;
}

field_shape choose_field(const scene::world_geometry& geometry, const field_bounds& all, lattice on,
                         std::vector<std::string>& warnings) {
  for (const double cut : {0.0, 0.005, 0.02, 0.05}) {
    const field_bounds world = cut == 0.0 ? all : bounds_of_middle(geometry, cut);
    const int voxels = fitting_voxels_per_cell(world, on.width());
    // A cell smaller than the coarse voxel is a voxel itself.
    if (voxels == 0 || (voxels > 1 && on.width() / voxels > coarse_voxel)) continue;
    if (voxels == 1 && on.width() > coarse_voxel) continue;
    if (cut > 0.0)
      warnings.push_back(fmt::format(
          "the scene is {:.0f} x {:.0f} m wide; floors are searched for in {:.0f} x {:.0f} m around most polygons, at "
          "heights of {:.0f} to {:.0f} m (--cells-grid or --cells-file reach further)",
          all.max.x - all.min.x, all.max.z - all.min.z, world.max.x - world.min.x, world.max.z - world.min.z,
          world.min.y, world.max.y));
    return shape_of(world, on, voxels);
  }
  int voxels = fitting_voxels_per_cell(all, on.width());
  while (voxels < 4) {  // with one voxel per cell there would be millions of cells
    on = on.coarser();
    voxels = fitting_voxels_per_cell(all, on.width());
  }
  field_shape shape = shape_of(all, on, voxels);
  warnings.push_back(
      fmt::format("the scene is {:.0f} x {:.0f} m wide: floors are searched for in steps of {:g} m, narrow passages "
                  "may have no cell",
                  all.max.x - all.min.x, all.max.z - all.min.z, shape.voxel));
  return shape;
}

player_moves moves_of(const player_settings& player, const field_shape& shape) {
  const auto up = [&](float meters) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(meters) / shape.step + 1e-6));
  };
  const auto height = static_cast<std::int32_t>(std::ceil(static_cast<double>(player.height) / shape.step - 1e-6));
  return {.height = std::max(1, height),
          .step = up(player.step),
          .jump = std::max(up(player.step), up(player.jump)),
          .gap = static_cast<std::int32_t>(static_cast<double>(player.gap) / shape.voxel)};
}

// Returns the space whose floor is below a point, at most 8 m; nothing if there is none.
std::optional<std::uint32_t> space_below(const open_field& open, const field_shape& shape,
                                         const std::array<float, 3>& point) {
  constexpr double deepest = 8.0, into_floor = 0.25;  // meters
  const double x = (static_cast<double>(point[0]) - shape.world.min.x) / shape.voxel;
  const double z = (static_cast<double>(point[2]) - shape.world.min.z) / shape.voxel;
  if (!(x >= 0.0 && x < static_cast<double>(shape.width) && z >= 0.0 && z < static_cast<double>(shape.depth)))
    return std::nullopt;
  const std::size_t column = static_cast<std::size_t>(z) * open.width + static_cast<std::size_t>(x);
  std::optional<std::uint32_t> found;
  for (std::uint32_t i = open.begins[column]; i < open.begins[column + 1]; ++i) {
    const double floor = shape.world.min.y + open.spaces[i].floor * shape.step;
    const double above = static_cast<double>(point[1]) - floor;
    if (above >= -into_floor && above <= deepest) found = i;  // the highest of them
  }
  return found;
}

// Returns for each region the number of polygons whose centers lie in its spaces or beside them, up to 8 m above the
// floor: floors, walls and things. The outside of a closed level and the bottom of its sky are large and made of few
// polygons; the inside has most of them.
std::vector<std::uint32_t> polygons_of_regions(const open_field& open, const field_shape& shape,
                                               const scene::world_geometry& geometry,
                                               const std::vector<std::uint32_t>& region_of, std::size_t regions) {
  constexpr double highest = 8.0;  // meters
  constexpr double slack = 2.0;    // voxels: the surfaces of a space are in the voxels at its ends
  constexpr std::size_t grain = 4096;
  struct counter {
    std::vector<std::uint32_t> counts, beside;
  };
  tbb::enumerable_thread_specific<counter> counters([&] { return counter{std::vector<std::uint32_t>(regions), {}}; });
  const auto count = [&](std::size_t p, counter& own) {
    if (!is_obstacle(geometry.kinds[p])) return;
    auto& [counts, beside] = own;
    const auto at = double_corners(geometry, p);
    const glm::dvec3 center = (at[0] + at[1] + at[2]) / 3.0 - shape.world.min;
    const glm::dvec3 voxel{center.x / shape.voxel, center.y / shape.step, center.z / shape.voxel};
    if (!(voxel.x >= 0.0 && voxel.x < shape.width && voxel.z >= 0.0 && voxel.z < shape.depth)) return;
    const int x = static_cast<int>(voxel.x), z = static_cast<int>(voxel.z);
    beside.clear();
    for (int dz = std::max(z - 1, 0); dz <= std::min(z + 1, shape.depth - 1); ++dz)
      for (int dx = std::max(x - 1, 0); dx <= std::min(x + 1, shape.width - 1); ++dx) {
        const std::size_t column = static_cast<std::size_t>(dz) * open.width + static_cast<std::size_t>(dx);
        for (std::uint32_t i = open.begins[column]; i < open.begins[column + 1]; ++i) {
          const open_space& space = open.spaces[i];
          const double top = std::min(space.ceiling + slack, space.floor + highest / shape.step);
          if (region_of[i] != no_region && voxel.y >= space.floor - slack && voxel.y <= top)
            beside.push_back(region_of[i]);
        }
      }
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    for (const std::uint32_t region : beside) ++counts[region];
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, geometry.kinds.size(), grain), [&](const auto& range) {
    counter& own = counters.local();
    for (std::size_t p = range.begin(); p < range.end(); ++p) count(p, own);
  });
  std::vector<std::uint32_t> sums(regions);
  for (const counter& one : counters)
    for (std::size_t region = 0; region < regions; ++region) sums[region] += one.counts[region];
  return sums;
}

// Returns the spaces where the flood begins, and describes them.
std::vector<std::uint32_t> starts_of(const open_field& open, const field_shape& shape, const player_moves& moves,
                                     const settings& how, const scene::world_geometry& geometry,
                                     walkable_cells& result) {
  // A camera is a start only where nothing else is, and only over a floor: many show the scene from far above.
  std::vector<std::uint32_t> starts, cameras;
  const auto add = [&](const std::array<float, 3>& point, bool is_camera) {
    if (const auto space = space_below(open, shape, point))
      (is_camera ? cameras : starts).push_back(*space);
    else if (!is_camera)
      result.warnings.push_back(
          fmt::format("no floor is within 8 m below the start ({:g}, {:g}, {:g}) m", point[0], point[1], point[2]));
  };
  for (const std::array<float, 3>& point : how.starts) add(point, false);
  if (how.starts.empty())
    for (const scene::start_point& start : geometry.starts) add(start.position, start.is_camera);
  const char* const what = starts.empty() ? "camera" : "start";
  if (starts.empty()) starts = cameras;
  if (!starts.empty()) {
    result.how = fmt::format("reached from {} {}{}", starts.size(), what, starts.size() == 1 ? "" : "s");
    return starts;
  }
  std::vector<std::uint32_t> sizes;
  const std::vector<std::uint32_t> region_of = find_regions(open, moves, sizes);
  if (sizes.empty()) return starts;
  const std::vector<std::uint32_t> polygons = polygons_of_regions(open, shape, geometry, region_of, sizes.size());
  // Several floors can belong to a level without a way that a flood finds: lifts, ladders, jump pads, closed doors.
  const std::uint32_t most = *std::max_element(polygons.begin(), polygons.end());
  const auto belongs = [&](std::uint32_t region) {
    const double area = sizes[region] * shape.voxel * shape.voxel;
    return polygons[region] == most || (area >= smallest_floor && polygons[region] >= share_of_richest * most);
  };
  std::vector<bool> started(sizes.size(), false);
  double area = 0.0;
  for (std::uint32_t space = 0; space < open.spaces.size(); ++space) {
    const std::uint32_t region = region_of[space];
    if (region == no_region || started[region] || !belongs(region)) continue;
    started[region] = true;
    area += sizes[region] * shape.voxel * shape.voxel;
    starts.push_back(space);
  }
  result.how = fmt::format(
      "reached from the {} with the most polygons around {}, {:.0f} square meters (--start chooses others)",
      starts.size() == 1 ? "floor" : fmt::format("{} floors", starts.size()), starts.size() == 1 ? "it" : "them", area);
  return starts;
}

// Returns the layers of the eyes above a floor.
eye_layers layers_of(const open_space& space, const field_shape& shape, const player_settings& player) {
  // The floor is somewhere in the topmost voxel of its span, and the ceiling in the lowest of its span.
  const double floor = shape.world.min.y + space.floor * shape.step;
  const double ceiling = shape.world.min.y + (space.ceiling + 1) * shape.step;
  const double highest = std::min(floor + static_cast<double>(player.highest_eye), ceiling);
  const double lowest = std::min(floor - shape.step + static_cast<double>(player.lowest_eye), highest);
  const auto layer_of = [&](double y) { return static_cast<std::int64_t>(std::floor(y / shape.on.height())); };
  return {layer_of(lowest), layer_of(highest) + 1, shape.voxel * shape.voxel, floor};
}

std::vector<floor_cell> collect_cells(const open_field& open, const std::vector<std::uint8_t>& reached,
                                      const field_shape& shape, const player_settings& player) {
  std::vector<floor_cell> found;
  std::vector<eye_layers> eyes;
  const int n = shape.voxels_per_cell;
  for (int cell_z = 0; cell_z < shape.depth / n; ++cell_z) {
    for (int cell_x = 0; cell_x < shape.width / n; ++cell_x) {
      eyes.clear();
      for (int z = cell_z * n; z < (cell_z + 1) * n; ++z) {
        for (int x = cell_x * n; x < (cell_x + 1) * n; ++x) {
          const std::size_t column = static_cast<std::size_t>(z) * open.width + static_cast<std::size_t>(x);
          for (std::uint32_t i = open.begins[column]; i < open.begins[column + 1]; ++i)
            if (reached[i] && open.spaces[i].walkable) eyes.push_back(layers_of(open.spaces[i], shape, player));
        }
      }
      add_floor_cells(eyes, {.z = shape.cells.first.z + cell_z, .x = shape.cells.first.x + cell_x}, found);
    }
  }
  std::sort(found.begin(), found.end(),
            [](const floor_cell& a, const floor_cell& b) { return a.position < b.position; });
  return found;
}

}  // namespace

walkable_cells find_walkable_cells(const scene::world_geometry& geometry, lattice on, const settings& how,
                                   const stop_request* stop) {
  const auto check = [&] {
    if (stop) stop->check();
  };
  walkable_cells result;
  result.on = on;
  const std::optional<field_bounds> all = bounds_of_obstacles(geometry);
  if (!all) return result;
  const field_shape shape = choose_field(geometry, *all, on, result.warnings);
  const player_moves moves = moves_of(how.player, shape);
  const open_field open = open_spaces(geometry, shape, moves, how, tbb::this_task_arena::max_concurrency(), stop);
  check();
  std::vector<std::uint8_t> reached(open.spaces.size(), 1);
  if (how.reach == reach_kind::walk)
    reached = find_reached(open, moves, starts_of(open, shape, moves, how, geometry, result));
  else
    result.how = "wherever there is head room";
  check();
  result.cells = collect_cells(open, reached, shape, how.player);
  result.on = shape.on;
  return result;
}

}  // namespace sightcell::bake
