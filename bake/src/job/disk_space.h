#pragma once
// Checks before a bake that the disks have room for what it writes. The amount is estimated from a few hemicubes.
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sightcell/bake/progress.h"

namespace sightcell::bake {

// An amount that will be written into a folder.
struct disk_need {
  std::filesystem::path folder;
  std::uint64_t bytes = 0;
};

// Return the bytes that a cell adds to the checkpoint, and to the .pvs file.
// polygons: how many polygons are in its set.
std::uint64_t checkpoint_bytes_of_cell(double polygons);
std::uint64_t file_bytes_of_cell(double polygons);

// Compares the needs of each disk with its free space. Needs on one disk are added. Sends a warning to events if less
// than twice the need is free. A disk that reports no size is taken as large enough.
// Throws sightcell::error "bake.disk-space" if less than a quarter of the need is free.
void check_disk_space(const std::vector<disk_need>& needs, const callbacks& events);

}  // namespace sightcell::bake
