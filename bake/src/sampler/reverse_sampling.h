#pragma once
// Reverse sampling (Wonka et al., Guided Visibility Sampling, SIGGRAPH 2006): where a border ray was blocked by
// something clearly closer, another eye may see past it.
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/base/box.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// Returns whether a ray that hit something at distance was blocked clearly before a point at reach.
bool is_blocked_before(float distance, float reach);

// A ray from eye toward border hit the occluder; border is a point next to a polygon that is visible from the eye at
// seen. The plane through the three points cuts the enlarged occluder in a segment. The lines from border past both
// of its ends are followed to the cell, and the points where they enter it are appended to eyes, at most two. If the
// occluder is in the cell, it is the middle of the line's part in the cell instead. A line that misses the cell adds
// nothing. The caller tests whether the eyes are valid viewpoints and what is visible from them.
// offset: as for enlarged().
void add_reverse_eyes(const triangle& occluder, const glm::vec3& eye, const glm::vec3& seen, const glm::vec3& border,
                      float offset, const box& cell, std::vector<glm::vec3>& eyes);

}  // namespace sightcell::bake
