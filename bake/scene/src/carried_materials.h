#pragma once
// Materials, textures, samplers and images of a file, to go into another one as they are.
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
  nlohmann::json sections = nlohmann::json::object();  // by their names in a document, also the extensions they use
  std::string copyright;
  // By number in images: bytes that want a buffer view there. Others could not be had and keep their URI.
  std::vector<std::pair<std::size_t, std::vector<std::uint8_t>>> images;
};

carried_materials carry_materials(const nlohmann::json& document, const json_object& root, const gltf_source& source,
                                  accessor_table& table, std::vector<std::string>& warnings);

}  // namespace sightcell::scene
