#pragma once
// The steps that workers are busy with, and which cell has been in work the longest.
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "cells/view_cell.h"
#include "sightcell/bake/progress.h"

namespace sightcell::bake {

using work_clock = std::chrono::steady_clock;
// Returns the time. Tests pass a clock of their own.
using time_source = std::function<work_clock::time_point()>;

struct step_in_work {
  std::uint32_t cell = 0;
  work_clock::time_point began{};
};

constexpr double slow_seconds = 10.0;  // progress names a cell that is in work for longer

// Returns the cell that has been in work the longest; nothing if it has been for less than at_least seconds.
// cells: all cells of the bake. A step of another cell is left out.
std::optional<slow_cell> longest_in_work(std::span<const step_in_work> steps, std::span<const view_cell> cells,
                                         work_clock::time_point now, double at_least);

}  // namespace sightcell::bake
