#pragma once
// The transform of a glTF node.
#include <glm/mat4x4.hpp>

namespace sightcell::scene {

// Returns the matrix of a translation (3 numbers), a rotation (a quaternion x, y, z, w) and a scale (3 numbers).
glm::dmat4 from_trs(const double* translation, const double* rotation, const double* scale);

}  // namespace sightcell::scene
