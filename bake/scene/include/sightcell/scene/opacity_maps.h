#pragma once
// Opacity maps: where on a masked polygon the alpha test passes everywhere, and where nowhere. A polygon is divided
// into equal parts, and each part is known or unknown, like the opacity micromaps of ray tracers (Gruen, Benthin and
// Woop, "Sub-triangle opacity masks for faster ray tracing of transparent objects", 2020). A test that skips the texels
// of known parts has the same result as one that reads them.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::scene {

struct alpha_mask;
struct masked_polygon;

// What the alpha test does in a part of a polygon.
enum class opacity : std::uint8_t { unknown, passes, fails };

// The parts of a polygon. Its edges are divided into `side` equal pieces, a power of 2. Barycentric coordinates u, v
// of the second and the third corner are in the square (floor(u side), floor(v side)); a square has two parts, the
// second one beyond its diagonal.
struct opacity_map {
  std::uint32_t first = 0, side = 0;  // index of the part (0, 0) in opacity_maps::parts; side 0: there are no parts
  opacity whole = opacity::unknown;   // of all parts
};

// The maps of the masked polygons of a scene. Polygons with the same mask, texture coordinates and vertex alphas share
// a map.
struct opacity_maps {
  std::vector<std::uint32_t> map_of;  // by index in world_geometry::masked: index in maps; empty: nothing is known
  std::vector<opacity_map> maps;
  std::vector<opacity> parts;  // 2 side^2 of each map, the square (u, v) at 2 (v side + u)

  // Returns what is known at a point of a polygon. Outside of the polygon nothing is.
  // masked: index in world_geometry::masked.
  // u, v: barycentric coordinates of the second and the third corner; any value, NaN too.
  // Cost: two reads of memory. Any thread.
  opacity at(std::size_t masked, float u, float v) const;
  // Returns what is known of a whole polygon.
  opacity whole(std::size_t masked) const { return map_of.empty() ? opacity::unknown : maps[map_of[masked]].whole; }
  std::size_t bytes() const;
};

// Makes the maps of polygons. A part passes or fails if all texels do that a bilinear lookup in its bounding box of
// texture coordinates can read; wrap modes and rounding are allowed for.
// Nothing is known of polygons whose vertex alphas differ, of masks with more than 2^24 texels, and of what is left
// when 2^28 texels were counted (once per mask and vertex alpha).
// Memory: at most 2^25 entries in `parts`; maps become coarser until that holds. During the call also 8 bytes for each
//   texel of one mask.
// Cost: linear in the texels counted and in the parts.
// Throws std::bad_alloc.
opacity_maps make_opacity_maps(std::span<const masked_polygon> polygons, std::span<const alpha_mask> masks);

}  // namespace sightcell::scene
