#pragma once
// Tests one verification ray against a cell set.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "bound/metric.h"
#include "bound/verification_rays.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// To be used by one thread at a time.
class ray_trial {
 public:
  ray_trial(const ray_scene& rays, const visibility_rules& rules, const std::function<bool(std::uint32_t)>& contains)
      : rays_(rays), rules_(rules), contains_(contains) {}

  // Returns whether the ray met anything that the set lacks. Rules 2 and 3 are not applied here, so they may still
  // excuse it.
  bool lacks(const sight_line& line, const sight& seen) const {
    const auto missing = [&](std::uint32_t polygon) { return !contains_(polygon); };
    if (seen.front != no_polygon && missing(seen.front)) return true;
    for (const passed_polygon& p : seen.before)
      if (missing(p.polygon)) return true;
    return rules_.volumes && rules_.volumes->lacks(line, free_length(seen));
  }

  // Appends to missed what the ray met and the set lacks. Returns whether the ray counts as a miss: it lacks something
  // that no rule excuses, and the metric counts it. Numbers of random may be used.
  bool test(const sight_line& line, const sight& seen, random_stream& random, std::vector<missed_polygon>& missed) {
    const bool polygons = lacks_polygons(line, seen, random, missed), volumes = lacks_volumes(line, seen);
    if (volumes && !polygons) ++misses_of_volumes_;
    return polygons || volumes;
  }
  // Totals over all rays so far.
  std::uint64_t misses_of_volumes() const { return misses_of_volumes_; }
  const std::vector<found_volume>& missed_volumes() const { return missed_volumes_; }

 private:
  bool lacks_volumes(const sight_line& line, const sight& seen) {
    if (!rules_.volumes) return false;
    rules_.volumes->lacking(line, free_length(seen), passed_);
    drop_behind_gaps(rays_, line, rules_.smallest_gap, passed_);
    for (const passed_volume& p : passed_) missed_volumes_.push_back({p.volume, line.eye});
    return !passed_.empty();
  }

  bool lacks_polygons(const sight_line& line, const sight& seen, random_stream& random,
                      std::vector<missed_polygon>& missed) {
    const std::size_t first = missed.size();
    lacking_.polygons.clear();
    lacking_.nearest = std::numeric_limits<float>::infinity();
    const auto check = [&](std::uint32_t polygon, float distance) {
      if (contains_(polygon) || rays_.through_gap(line.eye, line.direction, distance, rules_.smallest_gap)) return;
      rays_.coincident(line.eye, line.direction, distance, coincident_);
      // Rule 2: another polygon in the same place is in the set, so the picture is correct.
      const bool excused =
          std::any_of(coincident_.begin(), coincident_.end(), [&](std::uint32_t same) { return contains_(same); });
      missed.push_back({polygon, line.eye, distance, line.direction, !excused});
      if (excused) return;
      lacking_.polygons.insert(lacking_.polygons.end(), coincident_.begin(), coincident_.end());
      lacking_.nearest = std::min(lacking_.nearest, distance);
    };
    if (seen.front != no_polygon) check(seen.front, seen.distance);
    for (const passed_polygon& passed : seen.before) check(passed.polygon, passed.distance);
    if (lacking_.polygons.empty()) return false;
    const bool counts = rules_.metric->counts(line, seen, lacking_, contains_, random);
    for (std::size_t i = first; i < missed.size(); ++i) missed[i].counts = missed[i].counts && counts;
    return counts;
  }

  const ray_scene& rays_;
  const visibility_rules& rules_;
  const std::function<bool(std::uint32_t)>& contains_;
  std::vector<std::uint32_t> coincident_;
  lacking_surfaces lacking_;
  std::vector<passed_volume> passed_;
  std::uint64_t misses_of_volumes_ = 0;
  std::vector<found_volume> missed_volumes_;
};

}  // namespace sightcell::bake
