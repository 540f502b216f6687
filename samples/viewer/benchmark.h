#pragma once
// What drawing with the set costs along a path, against drawing everything.
#include <vector>

#include "camera_path.h"
#include "session.h"

namespace viewer {

// Draws each pose with the set and with everything, and writes a line of numbers for each: CSV with a heading. Prints
// the sums as one line of JSON. CPU times are those of the whole process: with a software rasterizer, of drawing too.
// Throws sightcell::error if the file cannot be written.
void run_benchmark(session& s, const std::vector<path_pose>& path, const options& chosen);

}  // namespace viewer
