// libFuzzer target: the list of cells in a checkpoint. What is let in is what a bake can work with.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "cells/cell_blocks.h"
#include "cells/decided_cells.h"

namespace {

using namespace sightcell::bake;

// Neighbors are found in pairs; how long that takes with many cells in one place is a matter of time, not of faults.
constexpr std::size_t blocks_limit = 200;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz_cells: %s\n", what);
  std::abort();
}

void check_cells(const std::vector<view_cell>& cells) {
  for (const view_cell& cell : cells) {
    for (int axis = 0; axis < 3; ++axis) {
      require(std::isfinite(cell.min[axis]) && std::isfinite(cell.max[axis]), "boxes are finite");
      require(cell.min[axis] < cell.max[axis], "boxes have volume");
    }
    require(std::isfinite(cell.floor) && std::isfinite(cell.floor_area) && cell.floor_area >= 0.0, "floors are finite");
    require(cell.on_lattice && cell.position.level >= 0 && cell.position.level <= cell_blocks::highest_level,
            "cells are on the lattice");
  }
  if (cells.size() > blocks_limit) return;
  const cell_blocks blocks(cells, 0.25f);
  require(blocks.cell_count() == cells.size(), "each cell is in a block");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto cells = decode_cells(bytes);
  if (!cells) return 0;
  require(encode(*cells) == bytes, "cells have one form");
  require(!cells->list.cells.empty() && cells->list.can_merge, "there are cells");
  require(cells->list.how.find('\n') == std::string::npos, "texts are lines");
  check_cells(cells->list.cells);
  check_cells(cells->boxes);
  return 0;
}
