#pragma once
// Adds polygons to cell sets of a .pvs file, without a scene. bake.h has the conventions.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace sightcell::bake {

// Polygons for one cell.
struct added_polygons {
  std::uint32_t cell = 0;
  std::uint32_t first = 0;  // source id of the first polygon
  std::uint32_t count = 1;  // polygons with consecutive source ids
};

struct patch_result {
  std::uint64_t added = 0;          // polygons that became members, over all cells
  std::uint64_t already_there = 0;  // polygons that were members before
  std::uint64_t bytes = 0;          // size of the new file
};

// Adds polygons and writes the new file. Bounds and certificate stay valid, because adding only lowers the error. If
// the file has importance, added polygons have the least. If it has texture residency, all textures of cells with added
// polygons have the finest level. The settings text of the file lists what was added. file: the bytes of the .pvs file.
// name: of the file, for messages. additions: in any order; may overlap. output: the new file; may be the file that was
// read. Fails with pvs.broken, patch.no-such-cell, patch.no-such-polygon, patch.not-written; then no file has changed.
// Cost: decodes and encodes the file once.
patch_result patch(std::span<const std::byte> file, const std::string& name, std::span<const added_polygons> additions,
                   const std::filesystem::path& output);

}  // namespace sightcell::bake
