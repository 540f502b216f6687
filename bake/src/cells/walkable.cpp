#include "cells/walkable.h"

#include <Recast.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <new>
#include <optional>

namespace sightcell::bake {

namespace {

constexpr double fine_voxel = 0.25;       // meters: the width of a person
constexpr double coarse_voxel = 0.5;      // meters: the widest that keeps doors and alleys open
constexpr double column_limit = 4 << 20;  // columns of the field: 32 MB of pointers, plus the spans
constexpr double fine_step = 0.1;         // meters, height of a voxel
constexpr double slope_limit = 0.70710;   // cosine of 45 degrees, rounded down so that 45 degrees itself counts

struct bounds {
  glm::dvec3 min{0.0}, max{0.0};
};

// The part of the world that becomes voxels, and their size.
struct field_shape {
  bounds world;  // snapped to the lattice in x and z
  lattice on{1.0};
  int voxels_per_cell = 1;   // along x and z
  int width = 0, depth = 0;  // voxels along x and z
  double voxel = 1.0, step = fine_step;
  lattice_range cells;
};

bool is_obstacle(const scene::polygon_kind& kind) {
  return !kind.absent && kind.alpha != scene::alpha_mode::blend;
}

std::array<glm::dvec3, 3> corners(const scene::world_geometry& geometry, std::size_t polygon) {
  std::array<glm::dvec3, 3> at;
  for (std::size_t i = 0; i < 3; ++i) at[i] = glm::dvec3(geometry.positions[geometry.indices[3 * polygon + i]]);
  return at;
}

std::optional<bounds> bounds_of_obstacles(const scene::world_geometry& geometry) {
  std::optional<bounds> found;
  for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
    if (!is_obstacle(geometry.kinds[p])) continue;
    for (const glm::dvec3& at : corners(geometry, p)) {
      if (!found) found = bounds{at, at};
      found->min = glm::min(found->min, at);
      found->max = glm::max(found->max, at);
    }
  }
  return found;
}

// Returns the bounds of most polygons: at each end of each axis a share `cut` of their centers is left out. A few
// polygons of a sky dome or of a distant terrain must not make the voxels of a level coarse.
bounds bounds_of_middle(const scene::world_geometry& geometry, double cut) {
  bounds middle;
  std::vector<double> centers;
  for (int axis = 0; axis < 3; ++axis) {
    centers.clear();
    for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
      if (!is_obstacle(geometry.kinds[p])) continue;
      const auto at = corners(geometry, p);
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

double columns_at(const bounds& world, double voxel) {
  const glm::dvec3 extent = world.max - world.min;
  return (extent.x / voxel + 1.0) * (extent.z / voxel + 1.0);
}

// Returns the largest number of voxels along a cell that the column limit allows for this part of the world; 0 if not
// even one fits.
int fitting_voxels_per_cell(const bounds& world, double cell) {
  // The field is snapped to the lattice, which adds up to a cell at each border.
  const bounds snapped{world.min - cell, world.max + cell};
  // 4096 gives voxels below a quarter of a meter for every permitted cell size.
  auto voxels = static_cast<int>(std::min(std::ceil(cell / fine_voxel), 4096.0));
  while (voxels > 0 && columns_at(snapped, cell / voxels) > column_limit) --voxels;
  return voxels;
}

field_shape shape_of(const bounds& world, const lattice& on, int voxels_per_cell) {
  field_shape shape;
  shape.world = world;
  shape.on = on;
  shape.voxels_per_cell = voxels_per_cell;
  shape.voxel = on.width() / voxels_per_cell;
  // Recast stores heights in 13 bits.
  shape.step = std::max(fine_step, (world.max.y - world.min.y) / (RC_SPAN_MAX_HEIGHT - 8));
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

field_shape choose_field(const scene::world_geometry& geometry, const bounds& all, lattice on,
                         std::vector<std::string>& warnings) {
  for (const double cut : {0.0, 0.005, 0.02, 0.05}) {
    const bounds world = cut == 0.0 ? all : bounds_of_middle(geometry, cut);
    const int voxels = fitting_voxels_per_cell(world, on.width());
    // A cell smaller than the coarse voxel is a voxel itself.
    if (voxels == 0 || (voxels > 1 && on.width() / voxels > coarse_voxel)) continue;
    if (voxels == 1 && on.width() > coarse_voxel) continue;
    if (cut > 0.0)
      warnings.push_back(fmt::format(
          "the scene is {:.0f} x {:.0f} m wide; floors are searched for in {:.0f} x {:.0f} m around most polygons "
          "(--cells-grid or --cells-file reach further)",
          all.max.x - all.min.x, all.max.z - all.min.z, world.max.x - world.min.x, world.max.z - world.min.z));
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

bool is_floor(const std::array<glm::dvec3, 3>& at, bool double_sided) {
  const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
  const double length = glm::length(normal);
  const double up = double_sided ? std::abs(normal.y) : normal.y;
  return length > 0.0 && up >= slope_limit * length;
}

struct free_heightfield {
  void operator()(rcHeightfield* field) const { rcFreeHeightField(field); }
};
using heightfield = std::unique_ptr<rcHeightfield, free_heightfield>;

heightfield rasterize(const scene::world_geometry& geometry, const field_shape& shape, bool all_double_sided) {
  rcContext context(false);
  heightfield field(rcAllocHeightfield());
  const glm::vec3 min(shape.world.min), max(shape.world.max);
  if (!field || !rcCreateHeightfield(&context, *field, shape.width, shape.depth, &min.x, &max.x,
                                     static_cast<float>(shape.voxel), static_cast<float>(shape.step)))
    throw std::bad_alloc();
  // Recast converts distances to int before it clips them, so polygons far outside would overflow.
  const double reach = 1e9 * shape.voxel;
  for (std::size_t p = 0; p < geometry.kinds.size(); ++p) {
    const scene::polygon_kind kind = geometry.kinds[p];
    if (!is_obstacle(kind)) continue;
    const auto at = corners(geometry, p);
    const glm::dvec3 low = glm::min(glm::min(at[0], at[1]), at[2]);
    const glm::dvec3 high = glm::max(glm::max(at[0], at[1]), at[2]);
    if (low.x < shape.world.min.x - reach || low.z < shape.world.min.z - reach || high.x > shape.world.max.x + reach ||
        high.z > shape.world.max.z + reach)
      continue;
    const unsigned char area = is_floor(at, kind.double_sided || all_double_sided) ? RC_WALKABLE_AREA : RC_NULL_AREA;
    const auto corner = [&](std::size_t i) { return &geometry.positions[geometry.indices[3 * p + i]].x; };
    if (!rcRasterizeTriangle(&context, corner(0), corner(1), corner(2), area, *field)) throw std::bad_alloc();
  }
  const int open_voxels = std::max(1, static_cast<int>(std::ceil(head_room / shape.step)));
  rcFilterWalkableLowHeightSpans(&context, open_voxels, *field);
  return field;
}

// Adds the heights (lattice y) of all eyes above one column of voxels.
void collect_heights(const rcSpan* span, const field_shape& shape, std::vector<std::int64_t>& heights) {
  for (; span != nullptr; span = span->next) {
    if (span->area == RC_NULL_AREA) continue;
    // The floor is somewhere in the topmost voxel of its span, so the height of the eye has an uncertainty of one
    // voxel.
    const double top = shape.world.min.y + static_cast<double>(span->smax) * shape.step + eye_height;
    const auto last = static_cast<std::int64_t>(std::floor(top / shape.on.height()));
    auto height = static_cast<std::int64_t>(std::floor((top - shape.step) / shape.on.height()));
    for (; height <= last; ++height) {
      if (heights.empty() || heights.back() != height) heights.push_back(height);
    }
  }
}

std::vector<lattice_position> collect_cells(const rcHeightfield& field, const field_shape& shape) {
  std::vector<lattice_position> found;
  std::vector<std::int64_t> heights;
  const int n = shape.voxels_per_cell;
  for (int cell_z = 0; cell_z < shape.depth / n; ++cell_z) {
    for (int cell_x = 0; cell_x < shape.width / n; ++cell_x) {
      heights.clear();
      for (int z = cell_z * n; z < (cell_z + 1) * n; ++z) {
        for (int x = cell_x * n; x < (cell_x + 1) * n; ++x)
          collect_heights(field.spans[static_cast<std::size_t>(z) * static_cast<std::size_t>(shape.width) +
                                      static_cast<std::size_t>(x)],
                          shape, heights);
      }
      std::sort(heights.begin(), heights.end());
      heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
      for (const std::int64_t height : heights)
        found.push_back({.z = shape.cells.first.z + cell_z, .y = height, .x = shape.cells.first.x + cell_x});
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

walkable_cells find_walkable_cells(const scene::world_geometry& geometry, lattice on, bool all_double_sided) {
  walkable_cells result;
  result.on = on;
  const std::optional<bounds> all = bounds_of_obstacles(geometry);
  if (!all) return result;
  const field_shape shape = choose_field(geometry, *all, on, result.warnings);
  const heightfield field = rasterize(geometry, shape, all_double_sided);
  result.positions = collect_cells(*field, shape);
  result.on = shape.on;
  return result;
}

}  // namespace sightcell::bake
