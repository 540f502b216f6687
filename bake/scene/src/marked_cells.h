#pragma once
// View cells that a scene contains: the boxes of nodes with extras.sightcell.cell.
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// Adds the box of a node to s.cells: the axis-aligned box of its mesh in world space, one for each instance. Without a
// mesh it is that of the cube from -1 to 1 m, as Blender shows an Empty of type Cube. A mesh without triangles adds a
// warning instead.
// first_draw: the draws of the node are those of s from there on; null for a node without a mesh.
void add_marked_cells(scene& s, std::uint32_t node, const glm::dmat4& to_world, const std::size_t* first_draw);

}  // namespace sightcell::scene
