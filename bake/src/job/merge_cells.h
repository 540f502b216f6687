#pragma once
// Merges automatic cells that see nearly the same polygons, before the bake.
#include <cstdint>
#include <functional>

#include "cells/view_cell.h"
#include "hemicube/hemicube_source.h"
#include "sightcell/bake/settings.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// What is merged, and with what.
struct merge_tools {
  const ray_scene& rays;
  hemicube_source& source;
  std::uint32_t own_polygons = 0;  // polygons of the scene that is baked; those of a second scene are not drawn
};

// Merges cells of one layer to squares of 2 x 2, 4 x 4 and 8 x 8 cells, as choose_cell_sizes() chooses them with
// how.merge_cells. The number of polygons visible from a square is estimated from full cubes: one at a random valid
// viewpoint in each of its cells, and one at each corner of a cell, which adjacent cells have in common. It is the
// expected number of polygons in the union of some of these cubes, drawn at random (rarefaction, Hurlbert 1971), so
// that no square seems to see more because more cubes were rendered there. A square of which less than half has floor
// is not considered. Where it has none, cubes are rendered as well, because the bake looks from there too. list: of
// level 0, from make_all_cells(), with can_merge. Becomes the merged cells; `how` and the order are new. With
//   how.cell_limit only that number of cells is kept, of some blocks (cell_blocks.h), and only those are considered.
// report: called on the calling thread, several times per second, with the share that is done; it may throw to end the
//   work.
// Returns the number of full cubes that were rendered.
// Deterministic: the same with any number of threads. Threads: as the source; works on the calling thread's TBB arena.
// Cost: about five hemicubes per cell.
std::uint64_t merge_cells(cell_list& list, const settings& how, const merge_tools& tools,
                          const std::function<void(double share)>& report);

}  // namespace sightcell::bake
