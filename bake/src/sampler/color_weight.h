#pragma once
// C of importance-depth-color: how much the textured picture of the whole scene differs from that of the cell set found
// so far, as one hemicube shows both.
#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "hemicube/surface_colors.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Mean |RGB difference|, 0..1, over the pixels of a hemicube from where, of which view is what it sees. Where the front
// polygon is in the set both pictures are the same; elsewhere a ray tells what the set shows behind it, so only what is
// new costs. Rows in parallel on the caller's arena; the result does not depend on threads.
double color_difference(const pose& where, const hemicube_view& view, hemicube_source& source, const ray_scene& rays,
                        const surface_colors& colors, const cell_set& set);

}  // namespace sightcell::bake
