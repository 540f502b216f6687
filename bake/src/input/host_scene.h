#pragma once
// Makes a scene from a host's arrays.
#include "sightcell/bake/host_scene.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Checks and copies the arrays, and calls the alpha functions. Throws sightcell::error (bad_input) with the number of
// the mesh, material or draw.
scene::scene scene_of(const host_scene& host);

// Throws sightcell::error (wrong_use) if the metric needs colors, which a host's arrays do not have.
void require_no_colors(const metric_settings& how);

}  // namespace sightcell::bake
