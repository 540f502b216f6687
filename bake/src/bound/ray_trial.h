#pragma once
// What one fresh ray is wrong about.
#include <cstdint>
#include <functional>
#include <vector>

#include "bound/fresh_rays.h"
#include "rays/ray_scene.h"

namespace sightcell::bake {

// One thread's.
class ray_trial {
 public:
  ray_trial(const ray_scene& rays, const fresh_rules& rules, const std::function<bool(std::uint32_t)>& contains)
      : rays_(rays), rules_(rules), contains_(contains) {}

  // Did the ray see anything that the set does not have? Rules 2 and 3 are not asked: what is missing may be excused.
  bool lacks(const sight& seen) const {
    const auto missing = [&](std::uint32_t polygon) { return !contains_(polygon); };
    if (seen.front != no_polygon && missing(seen.front)) return true;
    for (const passed_polygon& p : seen.before)
      if (missing(p.polygon)) return true;
    return false;
  }

  // Notes what the ray saw and the set does not have. True when the ray is wrong.
  bool judge(const sight_line& line, const sight& seen, std::vector<missed_polygon>& missed) {
    bool wrong = false;
    const auto check = [&](std::uint32_t polygon, float distance) {
      if (contains_(polygon) || rays_.through_gap(line.eye, line.direction, distance, rules_.smallest_gap)) return;
      rays_.coincident(line.eye, line.direction, distance, coincident_);
      bool excused = false;
      for (const std::uint32_t same : coincident_) excused = excused || contains_(same);
      missed.push_back({polygon, line.eye, distance, line.direction, excused});
      wrong = wrong || !excused;
    };
    if (seen.front != no_polygon) check(seen.front, seen.distance);
    for (const passed_polygon& passed : seen.before) check(passed.polygon, passed.distance);
    return wrong;
  }

 private:
  const ray_scene& rays_;
  const fresh_rules& rules_;
  const std::function<bool(std::uint32_t)>& contains_;
  std::vector<std::uint32_t> coincident_;
};

}  // namespace sightcell::bake
