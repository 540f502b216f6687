#pragma once
// What gvs and gvs++ have in common: rounds of random rays, and waves of rays that follow what was found.
#include <cstdint>
#include <functional>
#include <vector>

#include "cell_set/cell_set.h"
#include "sampler/cell_sampler.h"
#include "sampler/random_rays.h"
#include "sampler/ray_finds.h"
#include "sightcell/base/time_limit.h"

namespace sightcell::bake {

// What following one lead came to.
struct followed {
  std::vector<ray_find> found;
  std::uint64_t rays = 0;
};

// A wave works from one state of the set, in parallel on the calling thread's TBB arena; what it found joins after it.
class guided_search {
 public:
  // References must outlive the search. Time begins to count.
  guided_search(const settings& how, const sampler_world& world, const sampled_cell& cell, cell_set& set);

  std::uint64_t spent() const { return spent_; }
  bool over() const { return left() == 0 || limit_.reached(); }
  // One round of random rays; what they find waits to be followed.
  void look_at_random();
  // Follows all that waits, and what is found on the way. most: rays that one call may cast, at most; where fewer are
  // left nobody is followed. follow is called from several threads.
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
  std::vector<seed_ray> waiting_;  // the next one last
  std::vector<ray_find> found_;
};

}  // namespace sightcell::bake
