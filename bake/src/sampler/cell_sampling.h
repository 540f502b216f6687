#pragma once
// The hemicubes of one cell: boundary faces by the chosen sampler, full cubes at interior free points.
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "cell_set.h"
#include "free_space.h"
#include "random.h"
#include "source/hemicube_source.h"

namespace sightcell::bake {

struct sampling_plan {
  std::string_view sampler;
  std::uint32_t samples = 0;     // hemicubes, at most
  bool geometry_inside = false;  // half of the hemicubes become full cubes at interior points
  std::uint64_t seed = 0, place = 0;
};

// A full cube is two hemicubes back to back, so it counts as two samples.
inline std::uint32_t interior_cubes(const sampling_plan& plan) {
  return plan.geometry_inside ? plan.samples / 4 : 0;
}

// Renders the plan into set. is_free: may an eye be there? asked from many threads. interior: free points of the grown
// box, used in order. The boundary is sampled in rounds: each face that is not done proposes its next free place, all
// of them are one batch of the source, and the answers are given back in the order of the faces. So the result does not
// depend on threads; runs on the calling thread's TBB arena. Returns the number of hemicubes rendered; fewer than
// planned when faces lie in walls.
std::uint32_t sample_cell(const sampling_plan& plan, const box& grown, std::span<const glm::vec3> interior,
                          const std::function<bool(const glm::vec3&)>& is_free, hemicube_source& source, cell_set& set);

}  // namespace sightcell::bake
