#pragma once
// Writes a scene without its unseen polygons. bake.h has the conventions, unseen.h defines them.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/unseen.h"

namespace sightcell::bake {

struct strip_result {
  unseen_polygons unseen;
  std::uint32_t polygons = 0;         // of the stripped scene
  std::uint64_t bytes_before = 0;     // of the scene, with the files of buffers and images that it names
  std::uint64_t bytes = 0;            // size of the stripped file
  std::vector<std::string> warnings;  // of the scene, and of what stays whole; one line each
};

// Loads a scene and writes it as one .glb without its unseen polygons. sightcell/scene/strip.h describes the contents.
// A triangle goes when it is unseen in all instances of its mesh. Source ids of the stripped scene are others than
// those of the .pvs file.
// scene_path: the .glb or .gltf that was baked.
// scene_index: the glTF scene that was baked, -1 for the default scene of the file.
// file: the bytes of the .pvs file.
// name: of the file, for messages.
// output: the .glb to write. Empty: finds the unseen polygons alone.
// Fails with strip.too-large, strip.not-written, pvs.other-scene, pvs.broken, scene.*; then no file has changed.
// Cost: memory for the scene, twice for its file, and for the .glb.
strip_result strip(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                   const std::string& name, const std::filesystem::path& output);

}  // namespace sightcell::bake
