#pragma once
// The plain values of a .pvs file, as the writer takes them and the reader returns them. SPEC.md and layout.h define
// their bytes.
#include <array>
#include <cstdint>

namespace sightcell::format {

// An axis-aligned box in meters, glTF axes (right-handed, +Y up). Half-open: min <= p < max.
struct box {
  std::array<float, 3> min{};
  std::array<float, 3> max{};
};

// How the host stores its polygons. instanced: draw by draw; instances of one primitive share an index buffer, and so
// the order of their polygons. merged: flattened into world space, one list of polygons per draw group.
enum class host_layout : std::uint32_t { instanced = 0, merged = 1 };

// draw_record::flags: the host moves the draw. A merged file keeps it in a draw group of its own.
inline constexpr std::uint32_t draw_moves = 1;

// draw_record::named_group of a draw that is in none.
inline constexpr std::uint32_t no_named_group = 0xFFFFFFFFu;

// One entry of the draw table: a (node, primitive, instance) of the glTF scene. A polygon is one triangle of one draw.
struct draw_record {
  std::uint32_t node = 0;           // glTF node index
  std::uint32_t mesh = 0;           // glTF mesh index
  std::uint32_t primitive = 0;      // index of the primitive inside its mesh
  std::uint32_t instance = 0;       // index inside EXT_mesh_gpu_instancing, else 0
  std::uint32_t material = 0;       // glTF material index, 0xFFFFFFFF for the default material
  std::uint32_t group = 0;          // draw group of the merged layout, ascending from 0 without gaps; else 0
  std::uint32_t first_source = 0;   // source id of the draw's first polygon
  std::uint32_t polygon_count = 0;  // polygons of the draw
  // Polygons of all draws before this one in stored order. instanced: the stored number of its first polygon. merged:
  // all polygons of a draw group together are stored from first_stored of its first draw on, in an order of their own.
  std::uint32_t first_stored = 0;
  std::uint32_t base_vertex = 0;  // vertices of all draws before this one in source order
  std::uint64_t host_tag = 0;     // the host's own value, carried unchanged
  std::uint32_t flags = 0;        // draw_moves
  // The named group of the draw, which a host shows and hides, such as a door. Draws of one draw group are in the same
  // one, or all in none.
  std::uint32_t named_group = no_named_group;
};

// A position in the box of a cell, in steps of 1/4096 of its sides: 0 .. 4095 on each axis (eye_table.h).
using eye_steps = std::array<std::uint16_t, 3>;

// Result of the verification rays of one cell: misses of at least `rays` rays, and a one-sided upper bound of the miss
// probability ("pixel error") with the given confidence. The bound is Clopper-Pearson's, or a little above where the
// number of rays is itself a lower bound. rays = 0: nothing was measured for this cell and upper_bound is 1.
struct certificate_record {
  std::uint32_t cell = 0;
  std::uint64_t rays = 0;
  std::uint64_t misses = 0;
  double upper_bound = 1.0;
  double confidence = 0.95;
  std::uint64_t seed = 0;
};

// Polygons that are consecutive in stored order: first .. first + count - 1. count >= 1.
struct run {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

// Position of a cell on a lattice. Cells of level 0 are lattice_shape::width wide and deep and lattice_shape::height
// high, those of each further level half as large. The cell at (x, y, z) begins at (x w, y h, z w), with w and h the
// sizes of its level.
struct lattice_place {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint32_t level = 0;
};

// Size of cells of level 0, of volumes, or of the steps of a grid, in meters. Both finite and above 0.
struct lattice_shape {
  double width = 0.0;
  double height = 0.0;

  // The sizes of cells of a level, which is at most 31. The divisions are exact, and less code than std::ldexp.
  [[nodiscard]] double width_of(std::uint32_t level) const noexcept { return width / (std::uint32_t{1} << level); }
  [[nodiscard]] double height_of(std::uint32_t level) const noexcept { return height / (std::uint32_t{1} << level); }
};

// A box of whole steps of a grid. It begins at (x w, y h, z w), with w and h the width and height of a step.
struct grid_box {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint32_t steps_x = 1, steps_y = 1, steps_z = 1;  // each at least 1
};

// Facts about the whole file.
struct file_facts {
  std::uint32_t polygon_count = 0;
  host_layout layout = host_layout::instanced;
  float margin = 0.0f;           // meters by which cell boxes were grown for the bake
  float max_pixel_error = 1.0f;  // largest upper bound of any cell; 1 if one has none
  float confidence = 0.95f;
  bool repeatable = true;  // false: a time limit or a signal ended the bake
  // Invisible polygons in the sets as a share of the visible ones; 0: none. With clusters, the share of clusters.
  float slack = 0.0f;
  std::array<std::uint8_t, 16> scene_fingerprint{};
};

}  // namespace sightcell::format
