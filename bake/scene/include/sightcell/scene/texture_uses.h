#pragma once
// All textures of the materials of a glTF file, and how they lie on triangles: for texture residency. A scene itself
// has the base colors alone, because nothing else decides visibility. A texture here is an image of the file: mip
// levels belong to images. scene.h has the conventions.
#include <cstdint>
#include <filesystem>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sightcell::scene {

struct scene;  // sightcell/scene/scene.h

struct texture_info {
  std::uint32_t image = 0;              // glTF number
  std::uint32_t width = 0, height = 0;  // texels
};

// A texture of a material: its base color, normals, or any other one, also of extensions.
struct texture_use {
  std::uint32_t texture = 0;  // in texture_uses::textures
  std::uint32_t set = 0;      // TEXCOORD_<set>
  glm::dmat2 transform{1.0};  // KHR_texture_transform without its offset: uv' = transform * uv
};

struct texture_uses {
  std::vector<texture_info> textures;  // of all materials that draws have, ascending images
  std::vector<std::vector<texture_use>> of_material;

  // Texture coordinates as the file has them, by (mesh, primitive), then by set. Only those that uses name.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::map<std::uint32_t, std::vector<glm::vec2>>> coordinates;

  std::vector<std::string> warnings;  // images that are left out, one line each
};

// Reads the textures that the draws of a scene have. Images whose size cannot be read are left out.
// path: the file that the scene was loaded from.
// of: the scene.
// Fails with scene.*, as load_gltf does.
// Cost: reads the file and its images again; memory for the texture coordinates.
texture_uses read_texture_uses(const std::filesystem::path& path, const scene& of);

}  // namespace sightcell::scene
