#pragma once
// Guided Visibility Sampling++ (Koch and Wimmer, Proceedings of the ACM on Computer Graphics and Interactive
// Techniques, I3D 2021): iterations of very many random rays; around all that an iteration found many rays past its
// border, and from the view cell's edges toward what was hidden there.
#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sampler/cell_sampler.h"
#include "sightcell/base/box.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// Points on the border of the triangle, enlarged as seen from eye: its nine corners and samples more along each of its
// three long edges, all in their order around it.
std::vector<glm::vec3> border_points(const triangle& corners, const glm::vec3& eye, float offset,
                                     std::uint32_t samples);

// Samples points along each of the twelve edges of a box, in the middle of as many equal parts.
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
