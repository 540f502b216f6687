#pragma once
// Materials and the images that they use as base color, straight from the checked JSON.
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gltf_file.h"
#include "json_object.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Which coordinates a material's base color texture takes, and what KHR_texture_transform does to them.
struct texture_coordinates {
  std::uint32_t set = 0;                             // TEXCOORD_<set>
  glm::vec2 across{1, 0}, down{0, 1}, offset{0, 0};  // uv' = u across + v down + offset
  bool operator==(const texture_coordinates&) const = default;
};

struct material_set {
  std::vector<material> materials;               // by glTF material number
  std::vector<texture_coordinates> coordinates;  // likewise
  std::vector<image> images;                     // in order of first use
};

// bytes_of_view: the bytes of a buffer view. An image that cannot be had is a warning, not an error: the picture lacks
// it, what is seen stays the same.
material_set read_materials(const json_object& root, const gltf_source& source,
                            const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view,
                            std::size_t view_count, std::vector<std::string>& warnings);

}  // namespace sightcell::scene
