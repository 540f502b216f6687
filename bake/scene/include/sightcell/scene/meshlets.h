#pragma once
// Writes a glTF scene with its triangles in clusters (meshlets), and a table of these: `sightcell pack --meshlets`.
// scene.h has the conventions. docs/meshlets.md defines the table.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct meshlet_scene {
  std::vector<std::byte> glb;         // needs no other file
  std::uint32_t primitives = 0;       // that have meshlets
  std::uint32_t meshlets = 0;         // of all primitives, each once
  std::uint32_t coarse_meshlets = 0;  // likewise, of their levels of detail
  std::uint64_t triangles = 0;        // of all primitives, each once
  std::uint64_t drawn_meshlets = 0;   // of all draws: the clusters of a file that is baked with --granularity cluster
  std::uint64_t table_bytes = 0;
};

class gltf_meshlet_packer {
 public:
  // Loads a scene, as load_gltf does, and keeps the rest of the file.
  // path, scene_index: as for load_gltf.
  explicit gltf_meshlet_packer(const std::filesystem::path& path, int scene_index = -1);
  ~gltf_meshlet_packer();
  gltf_meshlet_packer(const gltf_meshlet_packer&) = delete;
  gltf_meshlet_packer& operator=(const gltf_meshlet_packer&) = delete;

  // Returns the scene. Valid as long as the packer.
  const scene& content() const;

  // Returns a .glb with the same nodes, meshes, primitives, vertex streams and materials. The triangles of each
  // primitive that a node of the scene draws are in the order of its clusters (clusters.h), which become its meshlets:
  // each is a range of the primitive's indices. extras.sightcell.clusters of the primitive has the number of the
  // meshlet of each triangle, and extras.sightcell.meshlets of the file the buffer view with the table. Triangles of
  // primitives with an extension that may refer to them keep their order, and their meshlets follow it. Vertices that
  // nothing uses go. Nothing is compressed but Draco primitives whose triangles keep their order.
  // progress: called with the triangles that are done, and all. May be null.
  // warnings: receives one line for each cause.
  // levels: adds levels of detail (cluster_dag.h) to the table.
  // Same file: same bytes.
  // Fails with scene.bad-field and others for a file that contradicts itself, pack.too-large above 4 GiB.
  meshlet_scene pack(const std::function<void(std::uint64_t done, std::uint64_t total)>& progress,
                     std::vector<std::string>& warnings, bool levels = false);

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::scene
