#pragma once
// Scenes of a few polygons in which one is seen only through a gap, each in as many variants as one likes.
#include <cstdint>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/scene/scene.h"

namespace sightcell::test {

struct gap_scene {
  scene::scene scene;
  bake::box cell;                     // its grown box; nothing is inside
  std::vector<std::uint32_t> hidden;  // polygons, of which any counts
  std::vector<bake::box> beside;      // other cells, which have to find it too
};

// A slit 0.3 m wide, anywhere in a wall along a cell of 12 m; what is behind it is seen from as much of that side.
// Nearly all of the side sees nothing but the flat wall.
gap_scene slit(std::uint64_t variant);
// The same, but a window of 0.7 x 0.7 m, off the middle in height as well.
gap_scene window(std::uint64_t variant);
// A tile of 3 cm between large ones, on a wall that a window far off shows a part of: who finds the large ones and
// looks past their borders has it.
gap_scene tile_behind_window(std::uint64_t variant);
// A corridor of sixteen cells with a small window at its end: one line of sight to what is behind it crosses many
// cells.
gap_scene corridor(std::uint64_t variant);
// A tile between large ones, which a plate hides from all but one end of the cell: who looks past the plate's border
// from where the tile is has it.
gap_scene tile_behind_plate(std::uint64_t variant);
// Two boxes with a crack of 0.25 m between them near one end of the cell, and what stands behind it.
gap_scene crack(std::uint64_t variant);

}  // namespace sightcell::test
