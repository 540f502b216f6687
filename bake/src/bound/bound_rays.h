#pragma once
// Fresh rays for the bound alone: their places are not tested one by one.
#include <cstdint>
#include <functional>

#include "bound/fresh_rays.h"

namespace sightcell::bake {

// Where fewer places are free all of them are tested: of rays that are cast from others many see what the set lacks.
inline constexpr double fewest_free = 0.005;

// What a batch for the bound may cost and risk.
struct bound_plan {
  std::uint64_t trials = 0;  // rays from free places that are wanted, about
  double free_share = 1.0;   // about this share of the grown box is free
  double risk = 0.0;         // of claiming more trials than there were, in (0, 1)
};

// As cast_fresh_rays: independent rays, place uniform over the free places of the grown box, direction by the metric.
// But a place takes 64 rays to test, so a place is tested only where its ray saw what the set does not have, and where
// it tells how many places are free: from the first of each chunk follows, with a probability of at least 1 - risk, how
// many of all are (free_at_least()), and so many trials the batch has. Given their number, wrong rays among trials are
// binomial, and more trials only lower the bound: with it at 1 - a it holds at 1 - a - risk. Where less than
// fewest_free of the box is free all places are tested, and trials are exact. rays: trials, at least; places: places
// that were tested and rays that were cast from others. Runs on the calling thread's TBB arena; the result depends on
// the arguments alone.
fresh_batch cast_bound_rays(const ray_scene& rays, const box& grown, const fresh_rules& rules, const bound_plan& plan,
                            const fresh_source& source, const std::function<bool(std::uint32_t)>& contains);

}  // namespace sightcell::bake
