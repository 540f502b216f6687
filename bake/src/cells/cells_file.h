#pragma once
// Explicit view cells from a JSON file: {"cells":[{"name":"lane 3","min":[x,y,z],"max":[x,y,z]}]}; what else it may
// hold is in overrides.h.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

// Reads the boxes in the order of the file. name is optional, unknown keys are ignored, metres throughout. Throws
// sightcell::error (bad_input) naming the file, the cell and what is wrong with it.
std::vector<view_cell> read_cells_file(const std::filesystem::path& path);

// The file's text; and the text's JSON. For overrides.h, which reads the rest of the file.
std::string read_cells_text(const std::filesystem::path& path);
nlohmann::json parse_cells_json(std::string_view text, const std::string& subject);

// The same from text; subject names it in errors.
std::vector<view_cell> parse_cells(std::string_view text, const std::string& subject);

}  // namespace sightcell::bake
