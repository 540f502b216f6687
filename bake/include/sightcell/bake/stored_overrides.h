#pragma once
// The overrides of a cells file that a .pvs file stores.
#include <string_view>

namespace sightcell::scene {
struct world_geometry;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// Makes a flattened scene what the bake had: polygons that the cells file listed as "never" become absent, those of
// "always" are in every set. To be called after scene::flatten by code that renders or
// traces the scene of a .pvs file.
// settings: the settings text of the file. Malformed entries are ignored.
// geometry: changed in place, with its bounds.
void apply_stored_overrides(std::string_view settings, scene::world_geometry& geometry);

}  // namespace sightcell::bake
