#pragma once
// Reads materials and the images of their base colors from the checked JSON.
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

// The texture coordinates of a material's base color, and the transform of KHR_texture_transform.
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

// Returns all materials. An image that cannot be read causes a warning and no error: pictures lack it, visibility stays
// the same. bytes_of_view: returns the bytes of a buffer view.
material_set read_materials(const json_object& root, const gltf_source& source,
                            const std::function<std::span<const std::uint8_t>(std::uint32_t)>& bytes_of_view,
                            std::size_t view_count, std::vector<std::string>& warnings);

}  // namespace sightcell::scene
