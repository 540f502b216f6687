#pragma once
// The factor C of importance-depth-color: the difference between the textured picture of the scene and that of the
// cell set found so far, in one hemicube.
#include "cell_set/cell_set.h"
#include "hemicube/hemicube_source.h"
#include "hemicube/surface_colors.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Returns the mean absolute RGB difference, 0..1, over the pixels of a hemicube. Where the front polygon is in the
// set both pictures are equal. For the other pixels a ray finds the polygon of the set behind, so the cost depends on
// what is new. Rows are processed in parallel in the caller's arena; the result does not depend on threads.
// where, view: the pose and its hemicube.
double color_difference(const pose& where, const hemicube_view& view, hemicube_source& source, const ray_scene& rays,
                        const surface_colors& colors, const cell_set& set);

}  // namespace sightcell::bake
