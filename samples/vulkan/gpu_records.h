#pragma once
// What buffers contain, as the shaders read it: shaders/scene.glsl, cull.glsl and clusters.comp have the same structs.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace vulkan_host {

inline constexpr std::uint32_t no_bin = 0xFFFFFFFFu;

struct vertex {
  glm::vec3 position;
  glm::vec2 uv;
  std::array<std::uint8_t, 4> tint;
};
static_assert(sizeof(vertex) == 24);

struct draw_record {
  glm::vec4 rows[3];  // to world space
  glm::vec4 sphere;   // world space: center, radius
  std::uint32_t first_index = 0;
  std::int32_t vertex_offset = 0;
  std::uint32_t bin = no_bin;
  std::uint32_t material = 0;
};
static_assert(sizeof(draw_record) == 80);

struct material_record {
  glm::vec4 base_color{1.0f};
  float alpha_cutoff = 0.0f;
  std::uint32_t base_texture = 0;        // layer of the texture array
  std::uint32_t wrap_u = 0, wrap_v = 0;  // sightcell::scene::wrap
};
static_assert(sizeof(material_record) == 32);

struct cluster_record {
  glm::vec4 sphere;  // world space
  std::uint32_t first_index = 0, index_count = 0;
  std::uint32_t draw = 0;
  std::uint32_t unused = 0;
};
static_assert(sizeof(cluster_record) == 32);

struct bin_record {
  std::uint32_t first_slot = 0;
  std::uint32_t compact_slots = 0;
};

struct draw_constants {
  glm::vec4 eye, clip_x, clip_y, clip_w;
};

struct cull_constants {
  glm::vec4 eye;
  std::array<glm::vec4, 5> planes;
  std::uint32_t count = 0, bin_count = 0;
};
static_assert(sizeof(cull_constants) == 104);

}  // namespace vulkan_host
