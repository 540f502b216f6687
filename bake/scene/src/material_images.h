#pragma once
// Which images and attributes of vertices materials use, and at what scale.
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace sightcell::scene {

// What the image of a texture contains.
enum class texture_kind { base_color, color, normals, numbers };

struct material_image {
  std::uint32_t image = 0;
  texture_kind kind = texture_kind::numbers;
  double scale = 1.0;  // largest one of KHR_texture_transform: repetitions of the image per unit of the coordinates
};

// Returns the images of each material, of any of its textures; numbers outside `images` are left out.
// sections: the sections of carried_materials.
std::vector<std::vector<material_image>> images_by_material(const nlohmann::json& sections);

// Returns the names of the attributes that the textures of each material need: TEXCOORD_n, and TANGENT for textures of
// normals and anisotropy. Textures count whether they have an image or not, also those of unknown extensions and
// extras.
// sections: the sections of carried_materials.
std::vector<std::set<std::string>> attributes_by_material(const nlohmann::json& sections);

}  // namespace sightcell::scene
