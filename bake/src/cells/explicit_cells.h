#pragma once
// View cells from boxes that a host or a file gives.
#include <span>
#include <string>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

inline constexpr std::size_t explicit_cell_limit = 1'000'000;

// Returns the boxes as cells, in their order.
// subject, remedy: for errors.
// Throws sightcell::error (bad_input) with the box and what is wrong with it.
std::vector<view_cell> explicit_cells(std::span<const cell_box> boxes, const std::string& subject,
                                      const std::string& remedy);

}  // namespace sightcell::bake
