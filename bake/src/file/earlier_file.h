#pragma once
#include <filesystem>

#include "sightcell/format/file_parts.h"

namespace sightcell::bake {

// Reads the draws and orders of the file of an earlier bake. Allocates about 20 bytes per polygon.
// Fails with pvs.broken.
format::file_parts read_earlier_file(const std::filesystem::path& pvs);

}  // namespace sightcell::bake
