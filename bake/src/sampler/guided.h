#pragma once
// The default: few hemicubes from evenly spread places, then rays beside what they saw and more hemicubes, whichever
// finds more for what it costs (search/cell_search.h).
#include "sampler/cell_sampler.h"

namespace sightcell::bake {

// Where there is an error to reach, sample() takes hemicubes alone: what they saw is shared with the cells around
// before the search goes on. Without one it searches until its hemicubes are taken, or its time is over.
class guided final : public cell_sampler {
 public:
  // References must outlive the sampler.
  guided(const settings& how, const sampler_world& world);

  sampling_effort sample(const sampled_cell& cell, cell_set& set) const override;
  std::optional<search_views> later_views(const sampled_cell& cell, std::uint32_t taken) const override;

 private:
  const settings& how_;
  const sampler_world world_;
};

}  // namespace sightcell::bake
