#pragma once
// Writes a glTF scene as one mesh in world space, for hosts that flatten their scenes: `sightcell pack`. scene.h has
// the conventions.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// ---- Order ----------------------------------------------------------------------------------------------------------

// A draw group: draws of one material whose polygons are stored in one stretch, or one draw that the host transforms.
struct packed_group {
  std::vector<std::uint32_t> draws;  // in scene::draws
  std::uint32_t first_stored = 0;    // stored number of its first polygon
  std::uint32_t polygon_count = 0;
  bool moves = false;  // the host transforms it
};

// The stored order of all polygons.
struct packed_order {
  std::vector<std::uint32_t> source_of_stored;  // each source id once
  std::vector<packed_group> groups;             // consecutive, from stored number 0 on
};

// ---- Packer ---------------------------------------------------------------------------------------------------------

class gltf_packer {
 public:
  // Loads a scene, as load_gltf does, and keeps what a scene does not have: normals, tangents, all texture coordinates.
  // path, scene_index: as for load_gltf.
  explicit gltf_packer(const std::filesystem::path& path, int scene_index = -1);
  ~gltf_packer();
  gltf_packer(const gltf_packer&) = delete;
  gltf_packer& operator=(const gltf_packer&) = delete;

  // Returns the scene. Valid as long as the packer.
  const scene& content() const;

  // Returns a .glb that needs no other file. Node n is draw group n; its primitive has the corners of the group's
  // polygons in stored order. All primitives share one accessor per attribute, whose vertices are numbered as in
  // world_geometry. Static draws are in world space and wound as flatten winds them. A draw that moves is a node with
  // its transform, in its rest pose. Materials keep their numbers.
  // order: of the .pvs file. Same scene and order: same bytes.
  // warnings: receives one line for each thing that the mesh cannot keep.
  // Fails with scene.bad-field and others for a file that contradicts itself, pack.too-large above 4 GiB.
  std::vector<std::byte> pack(const packed_order& order, std::vector<std::string>& warnings);

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::scene
