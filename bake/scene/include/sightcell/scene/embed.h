#pragma once
// A .pvs file that travels with its scene: `sightcell bake --embed`. scene.h has the conventions.
//
// A .glb contains it, as a buffer view of its first buffer; a .gltf names it. The root of the JSON has
//   "extras": {"sightcell": {"pvs": {"bufferView": N}}}     or     {"uri": "level.pvs"}
// Neither is part of the fingerprint of the scene.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct embedded_pvs {
  std::uint32_t buffer_view = no_index;  // of a .glb; no_index: a file
  std::string uri;                       // of the file, as the scene has it
  std::vector<std::byte> bytes;
};

// Returns the .pvs file that a scene contains or names; nothing if there is none.
// path: .glb or .gltf.
// Fails with scene.* if the scene cannot be read, or names a view or a file that cannot be read.
std::optional<embedded_pvs> read_embedded(const std::filesystem::path& path);

// Returns the bytes of a scene with a .pvs file, instead of the one that it has. The same call for the result returns
// the same bytes. All else is as in the scene; its JSON is written anew, with numbers of the same value. path: the
// scene, .glb or .gltf. pvs: the bytes; a .glb contains them. pvs_file: the file with these bytes; a .gltf names it.
// output: where the result will be written. Files that the scene names, and pvs_file, must be at or below its folder.
// Fails with scene.*; embed.separate-buffers for a .glb whose first buffer is another file; embed.outside-folder;
//   embed.too-large above 4 GiB.
std::vector<std::byte> with_embedded(const std::filesystem::path& path, std::span<const std::byte> pvs,
                                     const std::filesystem::path& pvs_file, const std::filesystem::path& output);

}  // namespace sightcell::scene
