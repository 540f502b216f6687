#pragma once
// Files that appear when they are complete.
#include <filesystem>
#include <string_view>

namespace sightcell::cli {

// Writes a file under another name in its folder and renames it: path has its old content or all of the new one.
// Fails with cli.not-writable.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace sightcell::cli
