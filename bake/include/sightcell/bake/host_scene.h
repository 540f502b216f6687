#pragma once
// A scene as an engine has it in memory: plain arrays, without glTF and without a math library. Functions that take a
// host_scene read the arrays during the call and keep nothing; all memory stays the caller's. bake.h has the
// conventions, and these hold besides:
//
// FRONT FACES are counter-clockwise. A transform that mirrors keeps the front side.
//
// SOURCE IDS count polygons draw by draw in the order of host_scene::draws, inside a draw in index order.
//
// DRAW TABLE. In the .pvs file, `node` of a draw is its number in host_scene::draws, `mesh` and `material` are the
// numbers that the draw names, `host_tag` is its tag, `primitive` and `instance` are 0.
//
// FAILURES. Arrays that contradict themselves: host.bad-array, scene.index-out-of-range, scene.bad-field.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "sightcell/scene/alpha_mode.h"

namespace sightcell::bake {

// ---- Meshes ---------------------------------------------------------------------------------------------------------

enum class index_format : std::uint8_t { u16, u32 };

// A triangle list, shared by all draws that name it.
struct host_mesh {
  const float* positions = nullptr;  // x, y, z of each vertex, meters; null only without vertices
  std::size_t position_stride = 0;   // bytes from vertex to vertex, a multiple of 4; 0 for 12, tightly packed
  std::size_t vertex_count = 0;

  const float* uvs = nullptr;  // u, v of each vertex, used where alpha is masked; null for (0, 0)
  std::size_t uv_stride = 0;   // bytes from vertex to vertex, a multiple of 4; 0 for 8, tightly packed

  const void* indices = nullptr;  // three per triangle, of index_type; null for vertices 0, 1, 2, ...
  std::size_t index_count = 0;    // a multiple of 3; not used if indices is null
  index_format index_type = index_format::u32;
};

// ---- Materials ------------------------------------------------------------------------------------------------------

// Alpha of each texel, filtered bilinearly.
struct host_texture {
  const std::uint8_t* alpha = nullptr;  // of the texel at u = 0, v = 0. RGBA8: pixels + 3, with a texel_stride of 4
  std::uint32_t width = 0;              // texels, 1 .. 16,384
  std::uint32_t height = 0;             // texels, 1 .. 16,384
  std::size_t texel_stride = 1;         // bytes from texel to texel
  std::size_t row_stride = 0;           // bytes from row to row; 0 for width * texel_stride
  scene::wrap wrap_u = scene::wrap::repeat;  // outside 0 .. 1
  scene::wrap wrap_v = scene::wrap::repeat;
};

struct host_material {
  std::string_view name;  // for messages
  scene::alpha_mode alpha = scene::alpha_mode::opaque;
  bool double_sided = false;

  // Of alpha_mode::mask. The polygon is visible and occludes where constant_alpha * alpha >= cutoff, with alpha from
  // `texture` or from `alpha_function`, at most one of them, or 1 without either.
  float cutoff = 0.5f;
  float constant_alpha = 1.0f;
  host_texture texture;

  // Alpha at (u, v), 0 .. 1; values outside are clamped, NaN counts as 0. Called at the start, on the calling thread,
  // once for each texel center of a grid over 0 .. 1: it repeats outside, with the precision of the grid.
  std::function<float(float u, float v)> alpha_function;
  std::uint32_t function_width = 256;   // texels of the grid, 1 .. 16,384
  std::uint32_t function_height = 256;  // texels of the grid, 1 .. 16,384
};

// ---- Draws ----------------------------------------------------------------------------------------------------------

// The material of a draw without one: opaque and single-sided.
inline constexpr std::uint32_t no_material = 0xFFFFFFFFu;

// What the host issues as one draw: a mesh with a transform.
struct host_draw {
  std::uint32_t mesh = 0;                // number in host_scene::meshes
  std::uint32_t material = no_material;  // number in host_scene::materials, or no_material

  // Local to world, column-major: x' = m[0] x + m[4] y + m[8] z + m[12]. The last row is not used.
  std::array<double, 16> to_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

  std::uint64_t tag = 0;       // any value; the runtime returns it as sightcell_draw::host_tag
  std::string_view name = {};  // for messages

  // Tags: docs/method/visibility-rules.md, rule 6. A draw without any is visible and occludes.
  bool occluder = true;   // false: non-occluder
  bool dynamic = false;   // left out: in no set, occludes nothing; the host decides by itself when to draw it
  bool always = false;    // in every set (sky, sea); occludes unless occluder is false or the draw is animated
  bool never = false;     // in no set, occludes nothing; stronger than always
  bool animated = false;  // it moves: settings::animated decides, unless it has one of the other tags

  // Name of a named group, such as a door, or empty: non-occluder, and the host can hide it by this name.
  std::string_view group = {};
};

// ---- Scene ----------------------------------------------------------------------------------------------------------

struct host_scene {
  std::string_view name = "host scene";  // for messages
  std::span<const host_mesh> meshes;
  std::span<const host_material> materials;
  std::span<const host_draw> draws;
};

}  // namespace sightcell::bake
