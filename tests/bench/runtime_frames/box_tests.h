#pragma once
// What it costs to ask whether anything in a box can be seen.
#include <cstdint>
#include <vector>

#include "bench/runtime_frames/frame_timing.h"

namespace sightcell::bench {

struct box_test_row {
  std::uint32_t volumes = 0;    // of 2 m, four layers
  double visible_share = 0.0;   // of the boxes
  double random_ns = 0.0;       // boxes of a person's size anywhere among the volumes, one after the other
  double walking_ns = 0.0;      // a thousand people who walk, each asked for in turn
  double with_origin_ns = 0.0;  // the first boxes, of a view with an origin of its own
};

// Volumes of our own, a tenth of which can be seen, here and there.
std::vector<box_test_row> measure_box_tests(const frame_timing& how);

}  // namespace sightcell::bench
