#pragma once
// Fresh rays for the bound alone: their places are not tested one by one.
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "bound/verification_rays.h"

namespace sightcell::bake {

// Where fewer places are free all of them are tested: of rays that are cast from others many see what the set lacks.
inline constexpr double fewest_valid = 0.005;

// What a batch for the bound may cost and risk.
struct bound_plan {
  std::uint64_t trials = 0;  // rays from free places that are wanted, about
  double valid_share = 1.0;  // about this share of the grown box is free
  double risk = 0.0;         // of claiming more trials than there were, in (0, 1)
};

// As cast_verification_rays: independent rays, place uniform over the free places of the grown box, direction by the
// metric. But a place takes 64 rays to test, so a place is tested only where its ray saw what the set does not have,
// and where it tells how many places are free: from the first of each chunk follows, with a probability of at least 1 -
// risk, how many of all are (valid_at_least()), and so many trials the batch has. Given their number, wrong rays among
// trials are binomial, and more trials only lower the bound: with it at 1 - a it holds at 1 - a - risk. Where less than
// fewest_valid of the box is free all places are tested, and trials are exact. rays: trials, at least; places: places
// that were tested and rays that were cast from others. Runs on the calling thread's TBB arena; the result depends on
// the arguments alone.
verification_batch cast_bound_rays(const ray_scene& rays, const box& grown, const visibility_rules& rules,
                                   const bound_plan& plan, const verification_stream& source,
                                   const std::function<bool(std::uint32_t)>& contains);

// The same, a part at a time: how long the batch becomes may depend on what came so far.
class bound_batch {
 public:
  // References must outlive the batch; contains must answer the same throughout. give_up: asked from many threads; once
  // it is true the batch is given up; empty: never.
  bound_batch(const ray_scene& rays, const box& grown, const visibility_rules& rules, double valid_share,
              const verification_stream& source, const std::function<bool(std::uint32_t)>& contains,
              std::function<bool()> give_up = {})
      : rays_(rays),
        grown_(grown),
        rules_(rules),
        free_share_(valid_share),
        source_(source),
        contains_(contains),
        give_up_(std::move(give_up)) {}

  // About so many more trials.
  void cast(std::uint64_t trials);
  // Then not all rays of the last part were cast, and which were depends on the time: the batch says nothing of what is
  // missing, and only what it missed is of use.
  bool given_up() const { return given_up_; }
  // At least so many trials so far, but for `risk`.
  std::uint64_t trials(double risk) const;
  std::uint64_t misses() const { return misses_; }
  // Sight rays and tested places.
  std::uint64_t spent() const { return cast_ + asked_; }
  // In a fixed order.
  const std::vector<missed_polygon>& missed() const { return missed_; }
  // Of the misses those that lack nothing that counts but volumes; and the volumes that were missed.
  std::uint64_t misses_of_volumes() const { return misses_of_volumes_; }
  const std::vector<found_volume>& missed_volumes() const { return missed_volumes_; }

 private:
  void cast_tested(std::uint64_t trials);

  const ray_scene& rays_;
  const box grown_;
  const visibility_rules& rules_;
  const double free_share_;
  const verification_stream source_;
  const std::function<bool(std::uint32_t)>& contains_;
  const std::function<bool()> give_up_;
  bool given_up_ = false;
  std::uint64_t cast_ = 0, tested_ = 0, free_ = 0;  // rays, from places of which some were tested, and are free
  std::uint64_t misses_ = 0, asked_ = 0;            // places asked about
  std::uint64_t parts_ = 0;
  std::vector<missed_polygon> missed_;
  std::uint64_t misses_of_volumes_ = 0;
  std::vector<found_volume> missed_volumes_;
};

}  // namespace sightcell::bake
