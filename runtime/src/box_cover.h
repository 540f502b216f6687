#pragma once
// Do boxes together hold all of another one?
#include <cstdint>
#include <span>

#include "box_tree.h"
#include "cell_box.h"

namespace sightcell::runtime {

// closed: with both ends. Cells count as boxes grown by margin. No for what takes more than a few thousand steps to
// find out, which no baked cells do.
[[nodiscard]] bool cells_cover(const wide_box& closed, std::span<const located_cell> cells, float margin) noexcept;

}  // namespace sightcell::runtime
