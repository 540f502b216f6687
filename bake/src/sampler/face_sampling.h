#pragma once
// Places hemicubes on the faces of a cell's grown box, with one face_sampler per face.
#include <functional>
#include <glm/vec3.hpp>
#include <string_view>

#include "sampler/face_sampler.h"
#include "search/hemicubes.h"
#include "sightcell/base/box.h"

namespace sightcell::bake {

// Samples the boundary in rounds. In each round every unfinished face proposes its next valid viewpoint, all of them
// are rendered as one batch, and the results are reported in the order of the faces, so the result does not depend on
// threads. Ends when the cell has no hemicubes left or all faces are finished or in walls. Runs on the calling
// thread's TBB arena.
// is_valid: returns whether a point is a valid viewpoint; called from many threads.
// weigh: may be null.
void sample_faces(const face_options& how, const hemicube_plan& plan, const box& grown,
                  const std::function<bool(const glm::vec3&)>& is_valid, hemicubes& cell,
                  const importance_weight& weigh = nullptr);

}  // namespace sightcell::bake
