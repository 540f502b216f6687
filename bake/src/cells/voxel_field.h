#pragma once
// The voxels of a scene for a player, by Recast: open spaces, and which of their floors are flat enough.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#include "cells/lattice.h"
#include "cells/reach.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/stop_request.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

inline constexpr double fine_step = 0.1;           // meters, height of a voxel
inline constexpr std::int32_t highest_voxel = 8191;  // Recast stores heights in 13 bits

struct field_bounds {
  glm::dvec3 min{0.0}, max{0.0};
};

// The part of the world that becomes voxels, and their size.
struct field_shape {
  field_bounds world;  // snapped to the lattice in x and z
  lattice on{1.0};
  int voxels_per_cell = 1;   // along x and z
  int width = 0, depth = 0;  // voxels along x and z
  double voxel = 1.0, step = fine_step;
  lattice_range cells;
};

// Polygons that a player cannot pass: opaque and MASK ones. BLEND ones are glass or water.
inline bool is_obstacle(const scene::polygon_kind& kind) {
  return !kind.absent && kind.alpha != scene::alpha_mode::blend;
}

// Returns the corners of a polygon.
std::array<glm::dvec3, 3> double_corners(const scene::world_geometry& geometry, std::size_t polygon);

// Rasterizes all obstacles as voxels. Returns the open spaces that are high enough for a player. They depend neither on
// the order of polygons nor on threads.
// stop: null for none. Throws step_stopped if it was asked.
// threads: of the arena of the calling thread, 1 or more; decides how many strips of the field are rasterized at once.
open_field open_spaces(const scene::world_geometry& geometry, const field_shape& shape, const player_moves& moves,
                       const settings& how, int threads, const stop_request* stop = nullptr);

}  // namespace sightcell::bake
