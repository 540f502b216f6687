#pragma once
// The polygons of a scene by content: names that do not depend on their numbers, and which polygons of two versions of
// a scene are the same.
#include <cstdint>
#include <vector>

#include "search/near_polygons.h"
#include "sightcell/scene/scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

struct polygon_table {
  // By polygon. A name is a hash of all that decides how a polygon is visible and what it occludes: its corners in
  // world space, its kind, and its mask with texture coordinates. 0 for absent polygons.
  std::vector<std::uint64_t> names;
  // By polygon: a hash of the names of its neighbors (near_polygons.h), from which dilation searches.
  std::vector<std::uint64_t> near;
  std::vector<triangle> corners;  // by polygon
};

// Fills in the names and the corners. Threads: runs in the TBB arena of the calling thread.
polygon_table table_of(const scene::world_geometry& geometry);

// Fills in the hashes of the neighbors. Threads: runs in the TBB arena of the calling thread.
void put_neighbors(const near_polygons& neighbors, polygon_table& table);

// What became of polygons in an edit.
struct polygon_edit {
  static constexpr std::uint32_t gone = 0xFFFFFFFFu;  // changed, moved or removed
  std::vector<std::uint32_t> new_of;                  // by old polygon: its new number, or `gone`
  std::vector<std::uint32_t> added;                   // new numbers of polygons that were not there, ascending
  std::vector<triangle> removed_corners;              // in the order of their old numbers
};

// Matches polygons of the same name: those that both scenes have in the same order at the beginning and at the end, and
// of the others the first with the first.
polygon_edit edit_between(const polygon_table& before, const polygon_table& now);

// Returns, by old polygon, 1 if it is not gone and has other neighbors.
std::vector<std::uint8_t> other_neighbors(const polygon_table& before, const polygon_table& now,
                                          const polygon_edit& edit);

}  // namespace sightcell::bake
