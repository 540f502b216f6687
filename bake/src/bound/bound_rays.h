#pragma once
// Verification rays for the bound, whose viewpoints are not tested one by one (docs/method/error-certificate.md,
// testing viewpoints late).
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "bound/verification_rays.h"

namespace sightcell::bake {

// If a smaller share of the region is valid, every viewpoint is tested. Most rays would start at invalid viewpoints
// otherwise, and many of those meet polygons that the set lacks.
inline constexpr double fewest_valid = 0.005;

// The size of a batch and the risk of its count of trials.
struct bound_plan {
  std::uint64_t trials = 0;  // approximate number of rays from valid viewpoints
  double valid_share = 1.0;  // estimated share of the region that is valid
  double risk = 0.0;         // probability of claiming more trials than there were, in (0, 1)
};

// Casts a batch of verification rays and counts its trials with a lower confidence limit.
// Rays are independent: the origin is uniform in the region, the direction is that of the metric. A test of a
// viewpoint takes up to 64 rays, so only two kinds of viewpoints are tested: those whose ray met something that the set
// lacks, and the first ones of each chunk. From the latter follows a lower limit for the number of valid viewpoints,
// which holds with a probability of at least 1 - risk (valid_at_least()). That number is the number of trials. Given
// the number of valid viewpoints, misses among trials are binomial, and more trials only lower the bound. So a bound
// computed at 1 - a holds with 1 - a - risk. If less than fewest_valid of the region is valid, every viewpoint is
// tested and the number of trials is exact.
// where: the box or region that viewpoints are drawn from.
// rules: what counts as a miss.
// source: names the random numbers.
// contains: returns whether a polygon is in the set. Called from several threads.
// Returns the batch. rays is the lower limit of the trials. places is the number of tested viewpoints plus the rays
// that were not trials.
// Threads: runs in the TBB arena of the calling thread. The result depends on the arguments alone.
verification_batch cast_bound_rays(const ray_scene& rays, const viewpoint_region& where, const visibility_rules& rules,
                                   const bound_plan& plan, const verification_stream& source,
                                   const std::function<bool(std::uint32_t)>& contains);

// The same batch, cast in parts. The size of a part may depend on the results of the parts before it.
class bound_batch {
 public:
  // All references must outlive the batch.
  // contains: as above; must return the same throughout.
  // give_up: called from several threads. Once it returns true the batch is given up. Empty: never.
  bound_batch(const ray_scene& rays, const viewpoint_region& where, const visibility_rules& rules, double valid_share,
              const verification_stream& source, const std::function<bool(std::uint32_t)>& contains,
              std::function<bool()> give_up = {})
      : rays_(rays),
        where_(where),
        rules_(rules),
        valid_share_(valid_share),
        source_(source),
        contains_(contains),
        give_up_(std::move(give_up)) {}

  // From now on, rays for which `changed` returns false are not cast, and count as hits: the caller knows their
  // results. changed: called from several threads. Empty: all rays are cast again.
  void cast_only(std::function<bool(const sight_line&)> changed) { changed_ = std::move(changed); }
  // Casts approximately this number of further trials.
  void cast(std::uint64_t trials);
  // Casts this number of further rays.
  void cast_rays(std::uint64_t count);
  // Returns the number of rays of each part so far. Another batch of the same source that casts these parts has the
  // same rays. Empty if every viewpoint is tested.
  const std::vector<std::uint64_t>& parts() const { return rays_of_parts_; }
  // Returns whether the batch was given up. Then some rays of the last part are missing, and which ones depends on
  // time. Such a batch bounds nothing; only the polygons that it found are of use.
  bool given_up() const { return given_up_; }
  // Returns a lower limit for the number of trials so far. It is wrong with a probability of at most `risk`.
  std::uint64_t trials(double risk) const;
  std::uint64_t misses() const { return misses_; }
  // Returns the cost so far: rays that were cast plus tested viewpoints.
  std::uint64_t spent() const { return traced_ + viewpoints_tested_; }
  // Returns the polygons that the rays met and the set lacks, in a fixed order.
  const std::vector<missed_polygon>& missed() const { return missed_; }
  // Returns the number of misses where only volumes count as missing; and the missing volumes.
  std::uint64_t misses_of_volumes() const { return misses_of_volumes_; }
  const std::vector<found_volume>& missed_volumes() const { return missed_volumes_; }

 private:
  void cast_tested(std::uint64_t trials);

  const ray_scene& rays_;
  const viewpoint_region where_;
  const visibility_rules& rules_;
  const double valid_share_;
  const verification_stream source_;
  const std::function<bool(std::uint32_t)>& contains_;
  const std::function<bool()> give_up_;
  bool given_up_ = false;
  // Rays, with those that count as hits; those that were cast; viewpoints tested for their share; valid ones among
  // those.
  std::uint64_t cast_ = 0, traced_ = 0, tested_ = 0, valid_ = 0;
  std::uint64_t misses_ = 0, viewpoints_tested_ = 0;  // viewpoints tested for any reason
  std::uint64_t parts_ = 0;
  std::vector<std::uint64_t> rays_of_parts_;
  std::function<bool(const sight_line&)> changed_;  // empty: all rays are cast
  std::vector<missed_polygon> missed_;
  std::uint64_t misses_of_volumes_ = 0;
  std::vector<found_volume> missed_volumes_;
};

}  // namespace sightcell::bake
