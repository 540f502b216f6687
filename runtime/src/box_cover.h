#pragma once
// Tests whether several boxes together contain another box.
#include <cstdint>
#include <span>

#include "box_tree.h"
#include "cell_box.h"

namespace sightcell::runtime {

// closed: both ends belong to it. cells: their boxes are grown by margin. Returns false also where the test would take
// more than a few thousand steps, which does not happen with baked cells.
[[nodiscard]] bool cells_cover(const wide_box& closed, std::span<const located_cell> cells, float margin) noexcept;

}  // namespace sightcell::runtime
