#pragma once
// Hemicubes on the faces of a cell's grown box, each face by a face_sampler of its own.
#include <functional>
#include <glm/vec3.hpp>
#include <string_view>

#include "sampler/face_sampler.h"
#include "search/hemicubes.h"
#include "sightcell/base/box.h"

namespace sightcell::bake {

// is_free: may an eye be there? asked from many threads. The boundary is sampled in rounds: each face that is not done
// proposes its next free place, all of them are one batch of the source, and the answers are given back in the order of
// the faces. So the result does not depend on threads; runs on the calling thread's TBB arena. Ends when cell has no
// hemicubes left, or earlier when all faces are done or lie in walls. weigh: may be null.
void sample_faces(const face_options& how, const hemicube_plan& plan, const box& grown,
                  const std::function<bool(const glm::vec3&)>& is_free, hemicubes& cell,
                  const importance_weight& weigh = nullptr);

}  // namespace sightcell::bake
