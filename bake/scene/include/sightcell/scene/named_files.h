#pragma once
// The files that a glTF file consists of. scene.h has the conventions.
#include <filesystem>
#include <vector>

namespace sightcell::scene {

// Returns the files of buffers and images that a glTF file names, whether they exist or not; none of a file that cannot
// be read.
// path: .glb or .gltf.
// Cost: reads the whole file.
std::vector<std::filesystem::path> named_files(const std::filesystem::path& path);

}  // namespace sightcell::scene
