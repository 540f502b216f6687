#pragma once
// Writes a city as one .glb, and its cells as JSON.
#include <filesystem>

#include "city.h"

namespace sightcell::city {

// Both throw sightcell::error (failed) when the file cannot be written.
// textured: the same polygons in the same order, with texture coordinates and embedded PNG textures.
void write_glb(const model& m, const std::filesystem::path& path, bool textured = false);
void write_cells(const model& m, const std::filesystem::path& path);

}  // namespace sightcell::city
