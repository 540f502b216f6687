#pragma once
// Explicit view cells from a JSON file: {"cells":[{"name":"lane 3","min":[x,y,z],"max":[x,y,z]}]}.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

// Reads the boxes in the order of the file. name is optional, unknown keys are ignored, metres throughout. Throws
// sightcell::error (bad_input) naming the file, the cell and what is wrong with it.
std::vector<view_cell> read_cells_file(const std::filesystem::path& path);

// The same from text; subject names it in errors.
std::vector<view_cell> parse_cells(std::string_view text, const std::string& subject);

}  // namespace sightcell::bake
