#pragma once
// The order in which a file has cells and polygons. Both are brought into it after the sets are known.
#include <cstdint>
#include <functional>
#include <vector>

#include "sightcell/bake/file_settings.h"
#include "sightcell/format/file_parts.h"

namespace sightcell::bake {

// Puts cells that lie on a lattice, by the settings text of parts, into its order, with their certificates. The answer
// is the number that each cell had; empty where cells keep theirs.
std::vector<std::uint32_t> order_cells(format::file_parts& parts);

// Puts the ascending source ids of a cell into set, which comes empty.
using set_source = std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& set)>;

// Orders polygons and draws anew, in the layout that the facts of parts say: draws, order_of_draw and orders of parts
// become others. Takes what store_draws does (stored_draws.h). set_of: by the numbers of the cells of parts.
void order_polygons_of(format::file_parts& parts, polygon_order_kind kind, const set_source& set_of);

}  // namespace sightcell::bake
