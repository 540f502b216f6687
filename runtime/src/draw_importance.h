#pragma once
// The part of the view that each draw covers, by the importance section of the file.
#include <span>

#include "view.h"

namespace sightcell::runtime {

// Writes the solid angles of all draws, or draw groups of a merged file, in sr: the largest of the cells that the view
// shows. 0 for draws without a polygon to draw.
// Fails as sightcell_view_importance; the elements are all 0 then.
sightcell_status write_draw_importance(const sightcell_view& view, std::span<float> by_draw) noexcept;

}  // namespace sightcell::runtime
