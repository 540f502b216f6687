#pragma once
// Guided Visibility Sampling++ (Koch and Wimmer, Proceedings of the ACM on Computer Graphics and Interactive
// Techniques, I3D 2021). Each iteration casts very many random rays. Then many rays go past the border of each
// polygon that the iteration found, and from the edges of the view cell toward border points that were occluded.
#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sampler/cell_sampler.h"
#include "sightcell/base/box.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// Returns points on the border of the triangle, enlarged as seen from eye, in their order around it: its nine points
// and `samples` more along each of its three long edges.
std::vector<glm::vec3> border_points(const triangle& corners, const glm::vec3& eye, float offset,
                                     std::uint32_t samples);

// Returns `samples` points along each of the twelve edges of a box, in the middle of equal parts.
std::vector<glm::vec3> edge_points(const box& cell, std::uint32_t samples);

class gvs_plus_plus final : public cell_sampler {
 public:
  // References must outlive the sampler.
  gvs_plus_plus(const settings& how, const sampler_world& world) : how_(how), world_(world) {}
  sampling_effort sample(const sampled_cell& cell, cell_set& set) const override;

 private:
  const settings& how_;
  const sampler_world world_;
};

}  // namespace sightcell::bake
