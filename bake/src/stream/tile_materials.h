#pragma once
// The materials of a tile.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace sightcell::bake {

class tile_materials {
 public:
  // sections: front field 4. image_uris: by image; empty where there is no file.
  tile_materials(const std::string& sections, std::vector<std::string> image_uris);

  // Adds the materials of these numbers to a glTF document, in this order, with the textures, samplers and images that
  // they use, and the extensions. A texture without a file is left out. Any number of threads at once.
  void put(std::span<const std::uint32_t> materials, nlohmann::ordered_json& document) const;

 private:
  nlohmann::ordered_json sections_;
  std::vector<std::string> image_uris_;
};

}  // namespace sightcell::bake
