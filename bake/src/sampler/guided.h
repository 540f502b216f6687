#pragma once
// The default sampler: a few hemicubes at evenly spread viewpoints, then rounds of hemicubes and of rays toward
// neighbors of known members (search/cell_search.h).
#include "sampler/cell_sampler.h"

namespace sightcell::bake {

// With an error target sample() renders hemicubes alone. Their finds are shared with adjacent cells before the search
// continues. Without a target sample() searches until its hemicubes are rendered or its time is over.
class guided final : public cell_sampler {
 public:
  // References must outlive the sampler.
  guided(const settings& how, const sampler_world& world);

  sampling_effort sample(const sampled_cell& cell, cell_set& set) const override;
  bool uses_device() const override { return world_.source.device_seconds().has_value(); }
  std::optional<search_views> later_views(const sampled_cell& cell, std::uint32_t taken) const override;

 private:
  const settings& how_;
  const sampler_world world_;
};

}  // namespace sightcell::bake
