#pragma once
// Guided Visibility Sampling (Wonka, Wimmer, Zhou, Maierhofer, Hesina, Reshetov, SIGGRAPH 2006): random rays find
// polygons. Border sampling finds polygons around them and reverse sampling those behind occluders.
#include "sampler/cell_sampler.h"

namespace sightcell::bake {

class gvs final : public cell_sampler {
 public:
  // References must outlive the sampler.
  gvs(const settings& how, const sampler_world& world) : how_(how), world_(world) {}
  sampling_effort sample(const sampled_cell& cell, cell_set& set) const override;

 private:
  const settings& how_;
  const sampler_world world_;
};

}  // namespace sightcell::bake
