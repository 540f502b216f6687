#pragma once
// Writes the mesh that goes with a .pvs file of the merged layout: the scene in world space, its polygons in stored
// order. bake.h has the conventions.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sightcell::bake {

struct pack_result {
  std::uint32_t polygons = 0;
  std::uint32_t vertices = 0;
  std::uint32_t groups = 0;           // draw groups
  std::uint32_t moving = 0;           // of groups: those that the host transforms
  std::uint64_t bytes = 0;            // size of the mesh file
  std::vector<std::string> warnings;  // one line each: of the scene, and what the mesh could not keep
};

// Loads a scene and writes it as one .glb. sightcell/scene/pack.h describes the contents.
// scene_path: the .glb or .gltf that was baked.
// scene_index: the glTF scene that was baked, -1 for the default scene of the file.
// file: the bytes of the .pvs file.
// name: of the file, for messages.
// output: the .glb to write.
// Fails with pack.instanced, pack.too-large, pack.not-written, pvs.other-scene, scene.*; then no file has changed.
// Cost: memory for the scene and for the .glb.
pack_result pack(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                 const std::string& name, const std::filesystem::path& output);

}  // namespace sightcell::bake
