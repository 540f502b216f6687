#pragma once
// The view cells of a bake, before it. bake.h has the conventions.
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/bake/settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// What bake() would bake.
struct cell_preview {
  std::vector<cell_box> cells;        // without the margin; in the order of the bake
  std::string how;                    // one line: how many cells, their width, and how they were chosen
  std::vector<std::string> warnings;  // one line each
};

// Returns the cells that the settings request (settings::cells_file and the options after it).
// s: the scene.
// how: settings::cells_from counts; everything about sampling is ignored.
// Fails with settings.* and cells.*, and with bake.nothing-to-see.
// Cost: up to some seconds and some hundred megabytes, for the voxels of automatic cells. Whether a cell has valid
//   viewpoints is not tested: the bake leaves out those that have none.
cell_preview preview_cells(const scene::scene& s, const settings& how);

}  // namespace sightcell::bake
