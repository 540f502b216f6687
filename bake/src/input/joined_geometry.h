#pragma once
// Two flattened scenes in one world.
#include <string>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Appends the polygons of another scene to geometry; the bounds become those of both. Levels of detail that only sets
// contain are left out.
// other_name: for messages.
// Throws sightcell::error if there are too many polygons or vertices.
void join(scene::world_geometry& geometry, scene::world_geometry&& other, const std::string& other_name);

}  // namespace sightcell::bake
