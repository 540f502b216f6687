#pragma once
// Base colors of the materials in the JSON of a front.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <string_view>
#include <vector>

#include "sightcell/scene/alpha_mode.h"

namespace stream_client {

inline constexpr std::uint32_t no_image = 0xFFFFFFFFu;

struct material {
  glm::vec4 base_color{1.0f};
  sightcell::scene::alpha_mode alpha = sightcell::scene::alpha_mode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  std::uint32_t image = no_image;  // of the base color
  std::uint32_t uv_set = 0;
  glm::vec2 uv_scale{1.0f}, uv_offset{0.0f};  // KHR_texture_transform
  float uv_rotation = 0.0f;                   // radians
  sightcell::scene::wrap wrap_u = sightcell::scene::wrap::repeat, wrap_v = sightcell::scene::wrap::repeat;
};

// Reads all materials; the last one is the default material of glTF.
// json: of sightcell_stream_json.
// Fails with client.materials.
std::vector<material> read_materials(std::string_view json);

}  // namespace stream_client
