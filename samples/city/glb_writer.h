#pragma once
// Writes a city as one .glb, and its cells as JSON.
#include <filesystem>

#include "city.h"

namespace sightcell::city {

// Both throw sightcell::error (failed) when the file cannot be written.
void write_glb(const model& m, const std::filesystem::path& path);
void write_cells(const model& m, const std::filesystem::path& path);

}  // namespace sightcell::city
