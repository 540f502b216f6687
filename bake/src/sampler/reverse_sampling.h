#pragma once
// Reverse sampling (Wonka et al., Guided Visibility Sampling, SIGGRAPH 2006): where a border ray was
// blocked by something clearly nearer, another eye may look past it.
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/base/box.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// Was a ray that met something at distance blocked clearly before a place at reach?
bool is_blocked_before(float distance, float reach);

// A ray from eye toward border, a point beside a polygon that the eye sees at seen, met the occluder. Of the plane
// through the three points the enlarged occluder cuts a stretch; the sight lines from border past both of its ends are
// turned round. Adds to eyes where they enter the cell (in the middle of what they have in it, where the occluder
// stands in the cell itself); a line that passes the cell by is not valid and adds nothing. Whether an eye is free and
// what it then sees is for the caller to find out. offset: as of enlarged(). At most two are added.
void add_reverse_eyes(const triangle& occluder, const glm::vec3& eye, const glm::vec3& seen, const glm::vec3& border,
                      float offset, const box& cell, std::vector<glm::vec3>& eyes);

}  // namespace sightcell::bake
