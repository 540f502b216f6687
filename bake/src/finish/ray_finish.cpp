#include "finish/ray_finish.h"

#include <algorithm>
#include <cmath>

#include "bound/clopper_pearson.h"
#include "finish/dilation.h"

namespace sightcell::bake {
namespace {

// A batch of only the rays that zero misses need would fail whenever the set is not far better than asked, so there is
// room for a few misses; not where free places are rare and every ray costs hundreds of tested places.
constexpr std::uint64_t headroom(double free_share) {
  return free_share < 0.05 ? 1 : 4;
}

}  // namespace

finish_result finish_with_rays(const ray_scene& rays, const near_polygons& neighbors, const box& grown,
                               const finish_settings& how, cell_set& set) {
  finish_result result;
  std::uint64_t wave = 0;
  const auto dilate_from = [&](std::size_t first) {
    const std::uint64_t left = how.max_rays - std::min(how.max_rays, result.rays_spent);
    result.rays_spent += dilate(rays, neighbors, {how.seed, how.place, how.rules.smallest_gap, left}, first, wave, set);
  };
  dilate_from(0);

  for (std::uint64_t batch = 1; result.rays_spent < how.max_rays; ++batch) {
    const double confidence = 1.0 - 0.05 / std::ldexp(1.0, static_cast<int>(std::min<std::uint64_t>(batch, 1000)));
    const std::uint64_t doubled = std::uint64_t{1} << std::min<std::uint64_t>(batch - 1, 20);
    const std::uint64_t wanted =
        headroom(how.free_share) * doubled * trials_without_miss(how.max_pixel_error, confidence);
    const std::uint64_t count = std::min(wanted, how.max_rays - result.rays_spent);
    const fresh_batch fresh =
        cast_fresh_rays(rays, grown, how.rules, count, {how.seed, how.place, purpose::bound, batch},
                        [&](std::uint32_t polygon) { return set.contains(polygon); });
    result.rays = fresh.rays;
    result.misses = fresh.misses;
    result.confidence = confidence;
    result.upper_bound = clopper_pearson_upper(fresh.misses, fresh.rays, confidence);
    result.bound_met = result.upper_bound <= how.max_pixel_error;
    result.rays_spent += std::max<std::uint64_t>(fresh.rays + fresh.places, 1);

    const std::size_t first = set.members().size();
    for (const missed_polygon& m : fresh.missed) set.add(m.polygon, m.eye);
    dilate_from(first);
    if (result.bound_met) break;
  }
  return result;
}

}  // namespace sightcell::bake
