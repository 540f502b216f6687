#pragma once
// The host's arrays as a scene.
#include "sightcell/bake/host_scene.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Checks and copies; calls alpha functions. Throws sightcell::error (bad_input) naming the mesh, material or draw.
scene::scene scene_of(const host_scene& host);

// Throws sightcell::error (wrong_use) where the metric looks at colors, of which a host's arrays have none.
void require_no_colors(const metric_settings& how);

}  // namespace sightcell::bake
