#pragma once
// A glTF scene as one mesh in world space, for hosts that flatten: `sightcell pack`.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// What the host draws together: draws of one material, whose polygons are stored one behind the other.
struct packed_group {
  std::vector<std::uint32_t> draws;  // into scene::draws
  std::uint32_t first_stored = 0, polygon_count = 0;
  bool moves = false;  // the host transforms it; it is then one draw
};

struct packed_order {
  std::vector<std::uint32_t> source_of_stored;  // every source id once, those of a group's draws in its place
  std::vector<packed_group> groups;             // one behind the other, from stored number 0 on
};

class gltf_packer {
 public:
  // Loads the scene as load_gltf does.
  explicit gltf_packer(const std::filesystem::path& path, int scene_index = -1);
  ~gltf_packer();
  gltf_packer(const gltf_packer&) = delete;
  gltf_packer& operator=(const gltf_packer&) = delete;

  const scene& content() const;

  // A .glb that names no other file. Vertices are numbered as world_geometry has them, in one accessor per attribute
  // that all primitives share; node n is group n, and its primitive has the corners of the group's polygons in stored
  // order. What does not move is in world space, wound as flatten() winds it; what moves is a node with the draw's
  // transform and stands as it rests. Materials keep their numbers. Same file and order, same bytes. Throws
  // sightcell::error: bad_input where the file contradicts itself or is too large for a .glb.
  // warnings: one line each is added for what could not be brought along.
  std::vector<std::byte> pack(const packed_order& order, std::vector<std::string>& warnings);

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::scene
