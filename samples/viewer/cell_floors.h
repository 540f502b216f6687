#pragma once
// The cells of a file as the floors of a map.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baked_scene.h"

namespace viewer {

struct map_floor {
  std::vector<std::uint32_t> cells;
  float lowest = 0.0f, highest = 0.0f;  // meters: bottoms of its cells
};

// Divides cells into floors, from the lowest up; each cell is in one. Cells that touch in plan and are about as high
// are of one floor, as on a slope. Floors that do not overlap in plan are one. Cost: O(n^2) for cells in one place,
// about a millisecond per thousand cells of a level.
std::vector<map_floor> floors_of(std::span<const cell> cells);

// A color for a share between 0 and 1, from blue by green and yellow to red: {red, green, blue} of 0 .. 1, sRGB.
std::array<float, 3> heat_color(float share);

}  // namespace viewer
