#pragma once
// The draw table and the orders of a file: from the scene's draws and the sets of all cells.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/bake/file_settings.h"
#include "sightcell/format/records.h"

namespace sightcell::bake {

struct stored_draws {
  std::vector<format::draw_record> draws;    // in stored order
  std::vector<std::uint32_t> order_of_draw;  // which of orders a draw has
  std::vector<std::vector<std::uint32_t>> orders;
};

// The draw table of the merged layout, before anything is known of what is seen: draws that have the same group become
// one draw group, numbered as they come in the source. Draws in any order.
std::vector<format::draw_record> in_groups(std::span<const format::draw_record> draws);

// Draws in any order whose source ids are gapless from 0; first_stored is not looked at. Instanced: draws of the same
// mesh and primitive share one order, since they share one index buffer in the host, unless kind says otherwise.
// Merged: draws of the same group are ordered together, whatever kind says; groups get other numbers. set_of puts the
// ascending source ids of a cell into set, which comes empty, and is asked seven times for each cell, ascending; what
// it throws comes through. The same answer on any number of threads (polygon_order.h).
stored_draws store_draws(std::span<const format::draw_record> draws, format::host_layout layout,
                         polygon_order_kind kind, std::uint32_t cell_count,
                         const std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& set)>& set_of);

}  // namespace sightcell::bake
