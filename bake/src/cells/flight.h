#pragma once
// Lattice cells where a camera is without a floor below it: in boxes (--fly), and near paths (--path, --path-camera).
#include <string>
#include <vector>

#include "cells/lattice.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct flight_cells {
  std::vector<lattice_position> cells;  // sorted, unique
  std::string how;                      // for messages: "in 2 boxes of --fly, within 0.5 m of 1 path"; empty: none
  std::vector<std::string> warnings;    // one line each
};

// Returns the lattice cells that share volume with a box of how.fly, and those whose box, grown by how.path_radius on
// all sides, meets a path of how.path_file or how.paths.
// geometry: its bounds are used for warnings only.
// Throws sightcell::error: "cells.too-many" (wrong_use) for more than a million cells, "cells.too-far", and what
//   read_paths() throws.
// Cost: O(n log n) of the lattice cells around all points of the paths.
flight_cells find_flight_cells(const scene::world_geometry& geometry, const lattice& on, const settings& how);

}  // namespace sightcell::bake
