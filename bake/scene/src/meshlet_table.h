#pragma once
// The binary table of meshlets of a packed file: docs/meshlets.md defines its bytes.
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

class meshlet_levels;  // meshlet_levels.h

constexpr std::uint32_t meshlet_table_version(bool with_levels) {
  return with_levels ? 2 : 1;
}

// A primitive with meshlets.
struct meshlet_group {
  std::uint32_t mesh = 0, primitive = 0;       // glTF
  std::vector<std::uint32_t> triangle_counts;  // by meshlet, 1 or more
  bool deforms = false;                        // by a skin or by morph targets
};

// Returns the size of the table without levels.
std::uint64_t meshlet_table_bytes(std::span<const meshlet_group> groups);

// Writes the table.
// packed: the scene as it is loaded from the packed file, whose triangles are in the order of the meshlets.
// levels: of the same scene; null: none.
// into: meshlet_table_bytes() bytes and those of the levels.
// Throws sightcell::error (bad_input) if a primitive has another number of triangles than its meshlets.
void write_meshlet_table(std::span<const meshlet_group> groups, const scene& packed, const meshlet_levels* levels,
                         std::span<std::byte> into);

}  // namespace sightcell::scene
