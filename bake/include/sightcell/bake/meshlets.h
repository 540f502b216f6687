#pragma once
// Writes a scene in meshlets, for hosts without a builder of their own. bake.h has the conventions.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sightcell::bake {

struct meshlet_result {
  std::uint32_t polygons = 0;         // of the scene, with all instances
  std::uint64_t triangles = 0;        // of primitives with meshlets, each once
  std::uint32_t primitives = 0;       // with meshlets
  std::uint32_t meshlets = 0;         // of these, each once
  std::uint32_t coarse_meshlets = 0;  // of their levels of detail, each once
  std::uint64_t drawn_meshlets = 0;   // of all draws: clusters of a bake with --granularity cluster
  std::uint64_t table_bytes = 0;      // of the table in the file
  std::uint64_t bytes = 0;            // size of the file
  std::vector<std::string> warnings;  // one line each: of the scene, and of primitives without meshlets
};

// Loads a scene and writes it as one .glb in meshlets. sightcell/scene/meshlets.h describes the contents. Source ids
// of the packed scene are others than those of the scene: bake the packed one.
// scene_path: a .glb or .gltf. scene_index: number of the glTF scene, -1 for the default scene of the file.
// output: the .glb to write.
// levels: adds levels of detail to the table.
// progress: called with the triangles that are in meshlets, and all. May be null.
// Fails with pack.too-large, pack.not-written, scene.*; then no file has changed.
// Cost: memory for the scene twice, twice for its file, and for the .glb.
meshlet_result pack_meshlets(const std::filesystem::path& scene_path, int scene_index,
                             const std::filesystem::path& output, bool levels,
                             const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {});

}  // namespace sightcell::bake
