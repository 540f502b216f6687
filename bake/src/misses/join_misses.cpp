#include "misses/join_misses.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "finish/aim.h"
#include "misses/look_at_polygon.h"

namespace sightcell::bake {

std::uint64_t join_misses(const ray_scene& rays, const fresh_rules& rules, std::span<const known_miss> misses,
                          cell_set& set) {
  std::vector<found_polygon> wanted;
  for (const known_miss& miss : misses)
    if (!set.contains(miss.polygon)) wanted.push_back({miss.polygon, miss.eye});
  const std::function<bool(std::uint32_t)> nothing = [](std::uint32_t) { return false; };
  std::vector<polygon_sight> sights(wanted.size());
  tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
    if (rays.is_free(wanted[i].eye, rules.player_radius))
      sights[i] = look_at_polygon(rays, rules.smallest_gap, wanted[i].eye, wanted[i].polygon, nothing);
  });
  std::uint64_t spent = 0;
  std::vector<found_polygon> found;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    spent += sights[i].rays;
    if (sights[i].seen) found.push_back(wanted[i]);
  }
  // Of several eyes that see a polygon the lowest is its witness.
  std::sort(found.begin(), found.end());
  for (const found_polygon& f : found) set.add(f.polygon, f.eye);
  return spent;
}

}  // namespace sightcell::bake
