#pragma once
// The boxes of view cells as a glTF file, for any viewer.
#include <filesystem>
#include <span>

#include "sightcell/bake/settings.h"

namespace sightcell::cli {

// Writes a .glb file with a translucent box per cell, a little smaller than the cell, in a color for each width: blue
// for the narrowest cells, red for the widest. Failure: throws sightcell::error "cli.not-writable"; nothing is left
// under the name.
void write_cells_glb(std::span<const bake::cell_box> cells, const std::filesystem::path& path);

}  // namespace sightcell::cli
