#pragma once
// Is there room on the disks for what a bake writes? A guess from few hemicubes, before hours of work.
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sightcell/bake/progress.h"

namespace sightcell::bake {

// So many bytes will be written into a folder.
struct disk_need {
  std::filesystem::path folder;
  std::uint64_t bytes = 0;
};

// What a cell writes whose middle sees so many polygons: the records of an unfinished bake, and the file.
std::uint64_t checkpoint_bytes_of_cell(double polygons_of_view);
std::uint64_t file_bytes_of_cell(double polygons_of_view);

// Needs on one disk are added. Where less than a quarter of that is free throws sightcell::error "bake.disk-space";
// where less than twice that is free, warns. Disks that do not tell are taken as empty.
void check_disk_space(const std::vector<disk_need>& needs, const callbacks& tell);

}  // namespace sightcell::bake
