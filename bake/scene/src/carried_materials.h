#pragma once
// Copies materials, textures, samplers and images of a file into another one unchanged.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "gltf_accessors.h"
#include "gltf_file.h"
#include "json_object.h"

namespace sightcell::scene {

struct carried_materials {
  // By their names in a document, including the extensions that they use.
  nlohmann::json sections = nlohmann::json::object();
  std::string copyright;
  // By number in images: bytes that need a buffer view in the other file. Images that could not be read keep their
  // URI.
  std::vector<std::pair<std::size_t, std::vector<std::uint8_t>>> images;
};

// Returns the materials of `document`, of which `root` is the checked access. warnings: receives one line per image
// that could not be read.
carried_materials carry_materials(const nlohmann::json& document, const json_object& root, const gltf_source& source,
                                  accessor_table& table, std::vector<std::string>& warnings);

}  // namespace sightcell::scene
