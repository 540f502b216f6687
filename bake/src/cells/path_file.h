#pragma once
// Reads paths of cameras from a JSON file: {"path":[[x,y,z],...]}, or {"paths":[[[x,y,z],...],...]}.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/bake/settings.h"

namespace sightcell::bake {

// Returns the paths of a file: that of "path" first. Unknown keys are ignored, lengths are in meters. Each path has at
// least one point.
// Throws sightcell::error (bad_input) with the file, the path, the point and what is wrong with it.
std::vector<camera_path> read_paths(const std::filesystem::path& path);

// As above, from a text.
// subject: names the text in errors.
std::vector<camera_path> parse_paths(std::string_view text, const std::string& subject);

}  // namespace sightcell::bake
