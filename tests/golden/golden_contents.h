#pragma once
// What the golden files of the writer's version hold.
#include <string>
#include <vector>

#include "unit/format/sample_contents.h"

namespace sightcell::test {

// small_contents() in an order of its own: draws in another order than the source has them, two of them instances that
// share an order, one empty; polygons permuted forwards and backwards.
sample_contents ordered_contents();
// Cells of two sizes on a lattice, in two chunks of rows and six of the lattice, on both sides of the origin.
sample_contents lattice_contents();
// Boxes of three widths and many heights on a grid, on both sides of the origin. Most meet at their sides; a few
// contain others.
sample_contents grid_contents();

// small_contents() in the merged layout: a group of two draws and an empty one, one of two, and a draw that moves.
sample_contents merged_contents();

// merged_contents() with three named groups.
sample_contents named_contents();

// lattice_contents() with viewpoints: whole boxes, trees of a few levels, and trees that are as deep as they may be.
sample_contents viewpoint_contents();

// ordered_contents() with 60 volumes on both sides of the origin.
sample_contents volume_contents();

// volume_contents() whose sets are of clusters.
sample_contents cluster_contents();
// named_contents(), in the merged layout, whose sets are of clusters.
sample_contents merged_cluster_contents();

struct golden_file_contents {
  std::string name;  // of the file without its ending
  sample_contents contents;
};

// All of them.
std::vector<golden_file_contents> golden_files();

}  // namespace sightcell::test
