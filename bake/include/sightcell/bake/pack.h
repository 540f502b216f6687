#pragma once
// The mesh that goes with a file in the merged layout: the scene in world space, its polygons as the file stores them.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sightcell::bake {

struct pack_result {
  std::uint32_t polygons = 0, vertices = 0, groups = 0;
  std::uint32_t moving = 0;  // groups that the host transforms
  std::uint64_t bytes = 0;
  std::vector<std::string> warnings;  // one line each: of the scene, and what could not be brought along
};

// Writes output, a .glb (sightcell/scene/pack.h says what it holds), by rename. file, name: as for verify. scene_index:
// the glTF scene that the file was baked from, -1: the default one. Throws sightcell::error when the file is of another
// layout or another scene, or when output cannot be written; then nothing was changed.
pack_result pack(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                 const std::string& name, const std::filesystem::path& output);

}  // namespace sightcell::bake
