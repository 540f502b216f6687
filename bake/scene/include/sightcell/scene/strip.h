#pragma once
// Writes a glTF scene without some of its polygons: `sightcell strip`. scene.h has the conventions.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct stripped_scene {
  std::vector<std::byte> glb;      // needs no other file
  std::uint32_t polygons = 0;      // of the scene that is left
  std::uint64_t source_bytes = 0;  // of the source: its file, and the files of buffers and images that it names
};

class gltf_stripper {
 public:
  // Loads a scene, as load_gltf does, and keeps the rest of the file.
  // path, scene_index: as for load_gltf.
  explicit gltf_stripper(const std::filesystem::path& path, int scene_index = -1);
  ~gltf_stripper();
  gltf_stripper(const gltf_stripper&) = delete;
  gltf_stripper& operator=(const gltf_stripper&) = delete;

  // Returns the scene. Valid as long as the stripper.
  const scene& content() const;

  // Returns the file without the triangles all of whose polygons are unwanted: in all nodes with their mesh, and in all
  // instances. These primitives stay whole: with morph targets, of nodes with a skin, of meshes that a node outside the
  // scene has, and with an extension that may refer to triangles. Primitives and meshes without triangles go, as do
  // vertices, accessors and buffer views that nothing uses. Nodes stay with names, extras and transforms. Materials,
  // textures and images stay. Other extensions are copied. Nothing is compressed but Draco primitives that stay whole.
  // unwanted: by source id.
  // warnings: receives one line for each cause.
  // Same file and same polygons: same bytes.
  // Fails with scene.bad-field and others for a file that contradicts itself, strip.too-large above 4 GiB.
  stripped_scene strip(const std::vector<bool>& unwanted, std::vector<std::string>& warnings);

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::scene
