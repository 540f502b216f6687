#pragma once
// A glTF file read with Assimp: the importer of this host, which knows nothing of Sightcell.
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sightcell/hosts/match.hpp"

namespace ogre_host {

// One mesh of one node: what becomes an entity, and what Sightcell calls a draw.
struct imported_draw {
  const aiNode* node = nullptr;
  std::uint32_t mesh = 0;  // in aiScene::mMeshes
};

struct imported_scene {
  std::unique_ptr<Assimp::Importer> importer;  // owns *scene
  const aiScene* scene = nullptr;
  std::vector<std::vector<std::uint32_t>> indices;  // by mesh, three per triangle
  std::vector<std::uint64_t> hashes;                // by mesh: its geometry hash; 0 without triangles
  std::vector<imported_draw> draws;                 // nodes depth-first; meshes with the hash 0 have none

  [[nodiscard]] sightcell::hosts::triangle_list triangles(std::uint32_t mesh) const;
};

// For the GPU: the flags of OGRE's own importer, which join vertices, reorder triangles and drop degenerate ones.
imported_scene import_for_drawing(const std::string& file);

// As the file has it: the triangles of each primitive are in the order of the file, which source ids count.
imported_scene import_as_stored(const std::string& file);

}  // namespace ogre_host
