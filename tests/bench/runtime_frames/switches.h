#pragma once
// What it costs to change to another cell, for each output.
#include <span>
#include <string>
#include <vector>

#include "bench/runtime_frames/frame_timing.h"

namespace sightcell::bench {

// Microseconds, medians over passes. Each output is asked for after the move and without it.
struct switch_row {
  std::string file;
  std::uint32_t cell = 0, polygons = 0, ranges = 0;
  double run_length = 0.0;  // polygons of a range
  bool cold = false;        // a buffer larger than all caches is walked before each call
  double move_us = 0.0;     // decodes to ranges
  double ranges_us = 0.0, polygons_us = 0.0, indices_us = 0.0, commands_us = 0.0, objects_us = 0.0;
  double memcpy_us = 0.0;   // as many bytes as the index list has
  double roaring_us = 0.0;  // the set as CRoaring's bitmap to ids
};

// sizes: for each the cell whose set comes nearest, warm and cold. Throws std::runtime_error.
std::vector<switch_row> measure_switches(const std::string& file, std::span<const std::uint32_t> sizes,
                                         const frame_timing& how);

}  // namespace sightcell::bench
