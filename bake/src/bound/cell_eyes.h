#pragma once
// Chooses the eyes of a cell: the valid viewpoints that its file gives to hosts.
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/format/records.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// Returns the eyes: first the one nearest to the middle of the known viewpoints, then those farthest from the ones
// before; one for each 8 m of the longest side of the cell, at most 4. Each is valid at the position that the file
// gives it, in the cell itself and in the region. Empty if no known viewpoint that is tested stays valid when its
// position is rounded. Depends on nothing but the arguments. own: the view cell, without its margin. region: the part
// of its grown box that its bound is about. radius: player radius in meters. known: valid viewpoints, inside or outside
// of the cell.
std::vector<format::eye_steps> choose_eyes(const ray_scene& rays, const box& own, const viewpoint_region& region,
                                           float radius, std::span<const glm::vec3> known);

}  // namespace sightcell::bake
