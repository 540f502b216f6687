#pragma once
// The floors of view cells as pictures from above.
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/cells.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

// Writes a picture per floor: PREFIX-1.png is the lowest. All have the same frame.
// geometry: of the scene of the cells.
// starts: where players begin, meters; drawn on the floor whose ground is nearest below.
// Returns the names of the files. Fails with picture.write; pictures before that one are written.
std::vector<std::filesystem::path> write_cells_plan(const bake::cell_preview& preview,
                                                    const scene::world_geometry& geometry,
                                                    std::span<const std::array<float, 3>> starts,
                                                    const std::string& prefix);

}  // namespace sightcell::cli
