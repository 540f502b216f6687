#pragma once
// What a host finds its draws by: geometry hashes, and names of nodes and meshes (SPEC.md, "Draw identity").
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/format/file_parts.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

struct draw_identity {
  std::vector<std::uint64_t> hashes;  // of the draws with polygons, in source order
  std::vector<std::string> node_names, mesh_names;
};

// Cost: O(triangles of all geometries).
draw_identity identity_of(const scene::scene& s);

// Replaces the identity in the content of a file.
void put_identity(const draw_identity& identity, format::file_parts& parts);

}  // namespace sightcell::bake
