#pragma once
// A walk through the automatic view cells of a scene, for scenes whose paths cannot be kept with the sources.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "bench/frames/path_file.h"
#include "cells/view_cell.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bench {

struct walk_settings {
  std::uint32_t frames = 400;
  float step = 0.25f;  // meters from frame to frame
  std::uint64_t seed = 1;
  std::optional<glm::vec3> near;  // where it begins; else in the middle of all corners of polygons
  unsigned starts = 48;           // cells, the nearest; the walk through the most cells is taken
};

// From cell to adjacent cell at eye height, straight on where it can, back where it cannot; never through a wall,
// always inside a cell. Turns smoothly. Has fewer frames where there is less room. Throws std::runtime_error where
// nobody can walk.
std::vector<path_frame> record_walk(const scene::world_geometry& geometry, const walk_settings& how);

// The automatic cells that the eyes of a path are in, in the order in which they are entered, each once. outside is
// raised by the number of eyes that are in none.
std::vector<bake::view_cell> cells_of(const scene::world_geometry& geometry, const std::vector<path_frame>& path,
                                      std::uint32_t& outside);

}  // namespace sightcell::bench
