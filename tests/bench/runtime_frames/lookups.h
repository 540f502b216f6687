#pragma once
// What it costs to find the cell of an eye.
#include <string>
#include <vector>

#include "bench/runtime_frames/frame_timing.h"

namespace sightcell::bench {

struct lookup_row {
  std::string kind;
  std::uint32_t cells = 0;
  double bytes_per_cell = 0.0;  // of memory that finds cells
  double random_ns = 0.0;       // an eye anywhere in the cells
  double coherent_ns = 0.0;     // a search each, along a path
  double frame_ns = 0.0;        // sightcell_view_move along the same path, without the frames that change cells
};

// Cells of our own: a square of one layer on a lattice, the same with two levels, and boxes of all sizes that overlap.
std::vector<lookup_row> measure_lookups(const frame_timing& how);

}  // namespace sightcell::bench
