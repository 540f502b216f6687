#pragma once
// What an edit did to the polygons of a scene since an earlier bake.
#include "sightcell/scene/scene.h"
#include "since/kept_records.h"
#include "since/polygon_table.h"
#include "trace/coincident.h"

namespace sightcell::bake {

struct scene_edit {
  // before: of the earlier bake; null: there was none.
  // Threads: runs in the TBB arena of the calling thread.
  scene_edit(const scene::world_geometry& geometry, const kept_records* before);

  polygon_table now;         // put_neighbors() adds the hashes of neighbors
  polygon_edit polygons;     // nothing without an earlier bake
  partners_before partners;  // the same
};

}  // namespace sightcell::bake
