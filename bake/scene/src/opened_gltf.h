#pragma once
// A scene together with the file that it came from, for code that writes parts of it into other files.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "gltf_accessors.h"
#include "gltf_attributes.h"
#include "gltf_file.h"
#include "import_scene.h"
#include "json_object.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct opened_gltf {
  gltf_source source;
  nlohmann::json document;
  std::optional<json_object> root;
  std::optional<accessor_table> table;
  std::optional<gltf_attributes> attributes;
  scene content;
  pose_list poses;
  std::vector<object_switches> switches;  // of levels of detail, by object

  // path, scene_index: as for load_gltf. Throws sightcell::error.
  opened_gltf(const std::filesystem::path& path, int scene_index);
  opened_gltf(const opened_gltf&) = delete;
  opened_gltf& operator=(const opened_gltf&) = delete;
};

}  // namespace sightcell::scene
