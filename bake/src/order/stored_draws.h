#pragma once
// Computes the draw table and the polygon orders of a file from the draws of the scene and the sets of all cells.
#include <cstdint>
#include <functional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "sightcell/bake/file_settings.h"
#include "sightcell/format/records.h"

namespace sightcell::bake {

struct stored_draws {
  std::vector<format::draw_record> draws;    // in stored order
  std::vector<std::uint32_t> order_of_draw;  // index into orders for each draw
  std::vector<std::vector<std::uint32_t>> orders;
};

// What draws are sorted by in source order. Draws without polygons have the same first_source as the next draw.
inline std::pair<std::uint32_t, bool> source_place(const format::draw_record& d) {
  return {d.first_source, d.polygon_count > 0};
}

// Draws of the instanced layout that share one order of polygons.
using draw_unit = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

// number: of the draw, in source order.
draw_unit unit_of(const format::draw_record& d, std::uint32_t number, polygon_order_kind kind);

// Fills in first_stored of draws in stored order.
void lay_end_to_end(std::span<format::draw_record> draws);

// Returns the draw table of the merged layout before polygons are ordered. Draws of one group become a draw group;
// groups are numbered in source order.
// draws: in any order.
std::vector<format::draw_record> in_groups(std::span<const format::draw_record> draws);

// Computes the stored order of draws and polygons.
// draws: in any order; their source ids have no gaps from 0. first_stored is ignored.
// layout: `instanced`: draws of the same mesh and primitive share one order, because they share one index buffer in the
//   host, unless kind is per_instance. `merged`: draws of one group are ordered together, whatever kind is, and groups
//   get new numbers.
// set_of: appends the source ids of a cell, ascending, to an empty set. It is called seven times for each cell, for
//   several cells at once. Its exceptions reach the caller.
// The result does not depend on the number of threads (polygon_order.h).
stored_draws store_draws(std::span<const format::draw_record> draws, format::host_layout layout,
                         polygon_order_kind kind, std::uint32_t cell_count,
                         const std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& set)>& set_of);

}  // namespace sightcell::bake
