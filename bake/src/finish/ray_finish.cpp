#include "finish/ray_finish.h"

#include <algorithm>
#include <cmath>

#include "bound/bound_rays.h"
#include "bound/clopper_pearson.h"
#include "finish/refinement.h"

namespace sightcell::bake {
namespace {

// The first batch has about the rays that zero misses need: what it misses is the best hint for the next, which is
// twice as large. A little more, because fewer count as trials than are cast; not where free places are rare and every
// ray costs hundreds of tested places.
constexpr double headroom(double free_share) {
  return free_share < 0.05 ? 1.02 : 1.25;
}

constexpr double share_of_places = 0.01;  // of a batch's risk: of taking too many places for free ones

}  // namespace

finish_result finish_with_rays(const ray_scene& rays, const near_polygons& neighbors, const box& grown,
                               const finish_settings& how, cell_set& set) {
  finish_result result;
  refinement beside(rays, neighbors, {how.seed, how.place, how.rules.smallest_gap}, 0, set);
  double worth = 4.0 * whole_sphere;
  const auto look_beside = [&] {
    const refinement_yield one = beside.run(worth, how.max_rays - std::min(how.max_rays, result.rays_spent));
    result.rays_spent += one.rays;
    return one.found_sr();
  };
  // Largest first, until what a step finds does not count any more.
  const auto refine_to = [&](double least) {
    for (double found = whole_sphere; result.rays_spent < how.max_rays && !beside.done();) {
      if (worth <= least * whole_sphere && found < 0.25 * how.max_pixel_error * whole_sphere) break;
      worth *= 0.25;
      found = look_beside();
    }
  };
  double least = how.max_pixel_error;
  refine_to(least);

  for (std::uint64_t batch = 1; result.rays_spent < how.max_rays; ++batch) {
    const double risk = 0.05 / std::ldexp(1.0, static_cast<int>(std::min<std::uint64_t>(batch, 1000)));
    const double of_misses = 1.0 - (1.0 - share_of_places) * risk;  // the rest is for how many places are free
    const std::uint64_t doubled = std::uint64_t{1} << std::min<std::uint64_t>(batch - 1, 20);
    const auto wanted = static_cast<std::uint64_t>(
        headroom(how.free_share) * static_cast<double>(doubled * trials_without_miss(how.max_pixel_error, of_misses)));
    const std::uint64_t count = std::min(wanted, how.max_rays - result.rays_spent);
    const fresh_batch fresh = cast_bound_rays(
        rays, grown, how.rules, {.trials = count, .free_share = how.free_share, .risk = share_of_places * risk},
        {how.seed, how.place, purpose::bound, batch}, [&](std::uint32_t polygon) { return set.contains(polygon); });
    result.rays = fresh.rays;
    result.misses = fresh.misses;
    result.confidence = 1.0 - risk;
    result.upper_bound = clopper_pearson_upper(fresh.misses, fresh.rays, of_misses);
    result.bound_met = result.upper_bound <= how.max_pixel_error;
    result.rays_spent += std::max<std::uint64_t>(fresh.rays + fresh.places, 1);

    for (const missed_polygon& m : fresh.missed) set.add(m.polygon, m.eye);
    (void)look_beside();
    if (result.bound_met) break;
    least /= 16.0;
    refine_to(least);
  }
  return result;
}

}  // namespace sightcell::bake
