#pragma once
// Which draw of a .pvs file each entity is, and which triangle of the glTF file each triangle of its mesh is. Needs a
// file that was baked with --names.
#include <cstdint>
#include <string>
#include <vector>

#include "importer.h"
#include "sightcell/hosts/match.hpp"
#include "sightcell/sightcell.hpp"

namespace ogre_host {

struct matched_scene {
  std::string file;  // for messages
  sightcell::db db;
  sightcell_info info{};
  std::vector<sightcell_draw> draws;               // the draw table of the file
  std::vector<std::uint32_t> draw_of_entity;       // numbers in it, by draw of the host's scene
  std::vector<std::uint32_t> entity_of_draw;       // the inverse; SIGHTCELL_NO_DRAW for draws without triangles
  std::vector<std::uint32_t> triangles_of_entity;  // an element of triangles, which instances share
  std::vector<sightcell::hosts::triangle_match> triangles;

  // A view of the file, one per camera. Throws host_error.
  [[nodiscard]] sightcell::view make_view() const;
};

// scene_file: is read once more, for the order of its triangles. host: as it is drawn.
// Throws host_error: the file cannot be used, or is of another scene.
matched_scene match_scene(const std::string& pvs_file, const std::string& scene_file, const imported_scene& host);

}  // namespace ogre_host
