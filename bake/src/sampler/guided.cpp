#include "sampler/guided.h"

#include <limits>

#include "finish/cell_search.h"

namespace sightcell::bake {
namespace {

constexpr double least_worth = 1e-9 * whole_sphere;  // sr, of rays without an error to reach

}  // namespace

guided::guided(const settings& how, const sampler_world& world) : how_(how), world_(world) {}

std::optional<search_views> guided::later_views(const sampled_cell& cell, std::uint32_t taken) const {
  const guided_places places{.seed = how_.seed,
                             .place = cell.place,
                             .player_radius = how_.player_radius,
                             .geometry_inside = cell.geometry_inside,
                             .resolution = world_.source.resolution(),
                             .taken = taken};
  return search_views{guided_views(world_.rays, cell.grown, places), world_.source};
}

sampling_effort guided::sample(const sampled_cell& cell, cell_set& set) const {
  const bool searches = how_.max_pixel_error == 0.0;
  const time_limit limit(how_.seconds_per_cell, world_.source.shared());
  auto views = later_views(cell, 0);
  views->most = how_.samples;
  cell_search search(world_.rays, *world_.neighbors, &*views,
                     {.seed = how_.seed, .place = cell.place, .smallest_gap = how_.smallest_gap, .limit = &limit}, set);
  search.look_for({.least_worth = searches ? least_worth : std::numeric_limits<double>::infinity()});
  return {.samples = views->places.taken(), .rays = search.rays()};
}

}  // namespace sightcell::bake
