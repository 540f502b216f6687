#pragma once
// A scene as an engine has it in memory: plain arrays, no glTF, no maths library. bake() and verify() read the arrays
// during their call and keep nothing of them; all memory stays the host's.
//
// Units: metres; axes right-handed, +Y up; front faces counter-clockwise (a mirroring transform keeps the front).
// Source ids: polygons are numbered draw by draw in the order of host_scene::draws, inside a draw in index order.
// In the file's draw table node is the number of the host_draw, mesh that of its mesh, primitive and instance are 0,
// material that of its material, host_tag its tag.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "sightcell/scene/alpha_mode.h"

namespace sightcell::bake {

inline constexpr std::uint32_t no_material = 0xFFFFFFFFu;

enum class index_format : std::uint8_t { u16, u32 };

// A triangle list, shared by all draws that name it.
struct host_mesh {
  const float* positions = nullptr;  // x, y, z of each vertex; not null unless vertex_count is 0
  std::size_t position_stride = 0;   // bytes from one vertex to the next, a multiple of 4; 0: 12, tightly packed
  std::size_t vertex_count = 0;
  const float* uvs = nullptr;     // u, v of each vertex; asked only where alpha is masked; null: all are (0, 0)
  std::size_t uv_stride = 0;      // as position_stride; 0: 8
  const void* indices = nullptr;  // three per triangle, in index_type; null: vertices 0, 1, 2, ... in order
  std::size_t index_count = 0;    // a multiple of 3; of null indices it is vertex_count and this is not read
  index_format index_type = index_format::u32;
};

// Alpha by texel: `alpha` points at the alpha byte of texel (0, 0), which is the one next to u = 0, v = 0. RGBA8 pixels
// are given as pixels + 3 with a texel_stride of 4. Looked up bilinearly.
struct host_texture {
  const std::uint8_t* alpha = nullptr;
  std::uint32_t width = 0, height = 0;                                     // 1 to 16,384
  std::size_t texel_stride = 1;                                            // bytes
  std::size_t row_stride = 0;                                              // bytes; 0: width x texel_stride
  scene::wrap wrap_u = scene::wrap::repeat, wrap_v = scene::wrap::repeat;  // beyond 0 and 1
};

struct host_material {
  std::string_view name;  // for messages
  scene::alpha_mode alpha = scene::alpha_mode::opaque;
  bool double_sided = false;
  // Of alpha_mode::mask alone: the polygon is there, seen and hiding, where constant_alpha x alpha >= cutoff. alpha is
  // texture's or alpha_function's (not both), else 1.
  float cutoff = 0.5f, constant_alpha = 1.0f;
  host_texture texture;
  // alpha at (u, v), 0 to 1, for procedural materials. Called from the calling thread, once per texel center of a grid
  // of function_width x function_height over 0..1, never during the bake: it has to repeat every 1 in u and v, and is
  // known only as finely as the grid. What is not a number counts as 0.
  std::function<float(float u, float v)> alpha_function;
  std::uint32_t function_width = 256, function_height = 256;  // 1 to 16,384
};

// What the host issues as one draw: a mesh at a place.
struct host_draw {
  std::uint32_t mesh = 0;                // into host_scene::meshes
  std::uint32_t material = no_material;  // into host_scene::materials; none: opaque, single-sided
  // Column-major, local to world: x' = m[0] x + m[4] y + m[8] z + m[12]. The last row is not read.
  std::array<double, 16> to_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::uint64_t tag = 0;       // anything: comes back as sightcell_draw::host_tag
  std::string_view name = {};  // for messages
  // Movable things (bake/METHOD.md, rule 6). Without any of these a draw is seen and hides what is behind it.
  bool occluder = true;   // false: seen, never hides
  bool dynamic = false;   // left out: in no set, hides nothing; the host draws it by a test of its own
  bool always = false;    // in every set (sky, sea, far terrain); hides unless occluder is false
  bool never = false;     // in no set, hides nothing; stronger than always
  bool animated = false;  // it moves: settings::animated decides, unless one of the others does; always hides nothing
  std::string_view group =
      {};  // not empty: seen, never hides, and the host hides all draws of that name itself (a door)
};

struct host_scene {
  std::string_view name = "host scene";  // for messages
  std::span<const host_mesh> meshes;
  std::span<const host_material> materials;
  std::span<const host_draw> draws;
};

}  // namespace sightcell::bake
