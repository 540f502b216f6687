#pragma once
// Facts about scenes and files that `sightcell info` prints. bake.h has the conventions.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace sightcell::scene {
struct world_geometry;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// Polygons with the same three corners as another one. Absent polygons do not count.
struct coincident_counts {
  std::uint32_t duplicates = 0;   // of the same kind and facing: one is visible exactly when the other is
  std::uint32_t any_winding = 0;  // of any kind and facing; includes the other two counts
  std::uint32_t opposite = 0;     // where windings differ
};

// Counts coincident polygons.
// Cost: sorts the polygons once.
coincident_counts count_coincident(const scene::world_geometry& geometry);

// Returns the size in bytes that a file would have without its visibility volumes, with the same cells and polygons in
// the same order.
// file: the bytes of the .pvs file.
// name: of the file, for messages.
// Fails with pvs.broken.
// Cost: nothing for a file without volumes, else it encodes the file once.
std::uint64_t size_without_volumes(std::span<const std::byte> file, const std::string& name);

}  // namespace sightcell::bake
