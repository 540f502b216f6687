#include "sightcell/scene/named_files.h"

#include <nlohmann/json.hpp>
#include <string>

#include "gltf_file.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::scene {

std::vector<std::filesystem::path> named_files(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files;
  const gltf_source source = source_of(path);
  nlohmann::json document;
  try {
    document = parse_json(split_gltf(read_scene_bytes(path), source.name).json, false);
  } catch (const error&) {
    return files;
  }
  if (!document.is_object()) return files;
  for (const char* section : {"buffers", "images"}) {
    const auto list = document.find(section);
    if (list == document.end() || !list->is_array()) continue;
    for (const nlohmann::json& one : *list) {
      const auto uri = one.is_object() ? one.find("uri") : one.end();
      if (!one.is_object() || uri == one.end() || !uri->is_string()) continue;
      if (auto file = file_of_uri(source, uri->get<std::string>())) files.push_back(*std::move(file));
    }
  }
  return files;
}

}  // namespace sightcell::scene
