#pragma once
// The common part of gvs and gvs++: rounds of random rays, and waves of rays that follow the seed rays.
#include <cstdint>
#include <functional>
#include <vector>

#include "cell_set/cell_set.h"
#include "sampler/cell_sampler.h"
#include "sampler/random_rays.h"
#include "sampler/ray_finds.h"
#include "sightcell/base/time_limit.h"

namespace sightcell::bake {

// The result of following one seed ray.
struct followed {
  std::vector<ray_find> found;
  std::uint64_t rays = 0;
};

// Follows seed rays in waves. A wave uses one state of the set and runs in parallel on the calling thread's TBB
// arena. Its finds join when it ends.
class guided_search {
 public:
  // References must outlive the search.
  guided_search(const settings& how, const sampler_world& world, const sampled_cell& cell, cell_set& set);

  // Returns the number of rays cast.
  std::uint64_t spent() const { return spent_; }
  // Returns whether the rays or the time are used up.
  bool over() const { return left() == 0 || limit_.reached(); }
  // Casts one round of random rays and queues the seed rays of their finds.
  void look_at_random();
  // Follows all queued seed rays, and those found on the way.
  // most: the largest number of rays that one call of follow may cast. If fewer are left, no seed ray is followed.
  // follow: called from several threads.
  void follow_all(std::uint64_t most,
                  const std::function<void(const seed_ray& from, noting_rays& rays, followed& out)>& follow);

 private:
  std::uint64_t left() const { return how_.sampling_rays - spent_; }
  void join(const std::vector<followed>& wave);

  const settings& how_;
  const ray_scene& rays_;
  cell_set& set_;
  const random_rays random_;
  const time_limit limit_;
  std::uint64_t spent_ = 0, round_ = 0;
  std::vector<seed_ray> waiting_;  // the next one is last
  std::vector<ray_find> found_;
};

}  // namespace sightcell::bake
