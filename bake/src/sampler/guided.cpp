#include "sampler/guided.h"

#include "search/cell_search.h"

namespace sightcell::bake {
namespace {

constexpr double error_without_one = 1e-5;  // without a target, rays are cast as for this one

}  // namespace

guided::guided(const settings& how, const sampler_world& world) : how_(how), world_(world) {}

std::optional<search_views> guided::later_views(const sampled_cell& cell, std::uint32_t taken) const {
  const guided_settings places{.seed = how_.seed,
                               .place = cell.place,
                               .player_radius = how_.player_radius,
                               .geometry_inside = cell.geometry_inside,
                               .resolution = world_.source.resolution(),
                               .taken = taken};
  return search_views{guided_views(world_.rays, cell.where(), places), world_.source};
}

sampling_effort guided::sample(const sampled_cell& cell, cell_set& set) const {
  auto views = later_views(cell, 0);
  views->most = how_.samples;
  cell_search search(world_.rays, *world_.neighbors, &*views,
                     {.seed = how_.seed,
                      .place = cell.place,
                      .smallest_gap = how_.smallest_gap,
                      .limit = cell.limit,
                      .priority = priority_beside(error_without_one)},
                     set);
  if (how_.max_pixel_error > 0.0)
    search.look_around();
  else
    search.look_for({});
  return {.samples = views->poses.taken(), .rays = search.rays()};
}

}  // namespace sightcell::bake
