#pragma once
// View cells that somebody gave as boxes.
#include <span>
#include <string>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

inline constexpr std::size_t explicit_cell_limit = 1'000'000;

// The boxes as cells, in their order. subject and remedy are for errors: sightcell::error (bad_input) names the box and
// what is wrong with it.
std::vector<view_cell> explicit_cells(std::span<const cell_box> boxes, const std::string& subject,
                                      const std::string& remedy);

}  // namespace sightcell::bake
