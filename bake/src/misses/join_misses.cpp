#include "misses/join_misses.h"

#include <tbb/parallel_for.h>

#include <functional>
#include <vector>

#include "misses/probe_polygon.h"

namespace sightcell::bake {

std::uint64_t join_misses(const ray_scene& rays, const visibility_rules& rules, std::span<const reported_miss> misses,
                          cell_set& set) {
  std::vector<reported_miss> wanted;
  for (const reported_miss& miss : misses)
    if (!set.contains(miss.polygon)) wanted.push_back(miss);
  const std::function<bool(std::uint32_t)> nothing = [](std::uint32_t) { return false; };
  std::vector<polygon_sight> sights(wanted.size());
  tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
    if (rays.is_valid(wanted[i].eye, rules.player_radius))
      sights[i] = probe_polygon(rays, rules.smallest_gap, wanted[i].eye, wanted[i].polygon, nothing);
  });
  std::uint64_t spent = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    spent += sights[i].rays;
    if (sights[i].seen) set.add(wanted[i].polygon, wanted[i].eye);
  }
  return spent;
}

}  // namespace sightcell::bake
