#pragma once
// Reads explicit view cells from a JSON file: {"cells":[{"name":"lane 3","min":[x,y,z],"max":[x,y,z]}]}. The file may
// also contain overrides (overrides.h).
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

// Returns the boxes of a file in their order. name is optional, unknown keys are ignored, lengths are in meters.
// Throws sightcell::error (bad_input) with the file, the cell and what is wrong with it.
std::vector<view_cell> read_cells_file(const std::filesystem::path& path);

// Returns the text of a file, and the JSON of a text, for overrides.h, which reads the rest of the file.
std::string read_cells_text(const std::filesystem::path& path);
nlohmann::json parse_cells_json(std::string_view text, const std::string& subject);

// As read_cells_file(), from a text.
// subject: names the text in errors.
std::vector<view_cell> parse_cells(std::string_view text, const std::string& subject);

}  // namespace sightcell::bake
