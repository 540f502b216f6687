#pragma once
// What buffers contain, as the shaders read it: shaders/records.glsl and view.glsl have the same structs.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace gpu_driven {

struct vertex {
  glm::vec3 position;
  glm::vec2 uv;
  std::array<std::uint8_t, 4> tint;
};
static_assert(sizeof(vertex) == 24);

// Attributes that advance per instance. Each cluster is an instance of its own.
struct instance_record {
  glm::vec4 rows[3];  // to world space
  std::uint32_t cluster = 0, material = 0;
};
static_assert(sizeof(instance_record) == 56);

struct cluster_record {
  glm::vec4 sphere{0.0f};  // world space: center, radius
  glm::vec4 cone{0.0f};    // axis, and the cosine from which on all its triangles face away; above 1: never
  glm::vec3 min{0.0f};     // world space: its box
  std::uint32_t first_index = 0;
  glm::vec3 max{0.0f};
  std::uint32_t index_count = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t bin = 0;
  std::uint32_t is_blended = 0;
  std::uint32_t made_by = 0xFFFFFFFFu;    // its level groups (level_table.h), in the buffer of them; none
  std::uint32_t member_of = 0xFFFFFFFFu;  // likewise
  std::array<std::uint32_t, 3> unused{};
};
static_assert(sizeof(cluster_record) == 96);

struct level_group_record {
  glm::vec4 sphere{0.0f};  // world space: center, radius
  float error = 0.0f;      // meters
  std::array<std::uint32_t, 3> unused{};
};
static_assert(sizeof(level_group_record) == 32);

struct draw_command {  // DrawElementsIndirectCommand
  std::uint32_t index_count = 0, instance_count = 0, first_index = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t base_instance = 0;
};
static_assert(sizeof(draw_command) == 20);

struct bin_record {
  std::uint32_t first_slot = 0;
  std::uint32_t compact_slots = 0;  // 1: the commands of visible clusters follow each other
};

struct material_record {
  glm::vec4 base_color{1.0f};
  float alpha_cutoff = 0.0f;
  std::uint32_t base_texture = 0;        // layer of the texture array
  std::uint32_t wrap_u = 0, wrap_v = 0;  // sightcell::scene::wrap
};
static_assert(sizeof(material_record) == 32);

struct camera_record {
  glm::vec4 eye;                     // w: distance of the near plane
  glm::vec4 clip_x, clip_y, clip_w;  // clip_x.w: 1 / distance of the haze
  std::array<glm::vec4, 5> planes;   // normals of the frustum to the inside
  glm::vec4 size;                    // pixels: width, height; meters of a pixel at a distance of 1 m
};
static_assert(sizeof(camera_record) == 160);

}  // namespace gpu_driven
