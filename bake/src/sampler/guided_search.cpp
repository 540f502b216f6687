#include "sampler/guided_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace sightcell::bake {
namespace {

// Between waves the time is checked and finds join. The size of a wave changes only rays that find what another ray
// of the wave finds too.
constexpr std::uint64_t rays_of_wave = 65536;

}  // namespace

guided_search::guided_search(const settings& how, const sampler_world& world, const sampled_cell& cell, cell_set& set)
    : how_(how),
      rays_(world.rays),
      set_(set),
      random_(world.rays,
              {.seed = how.seed,
               .place = cell.place,
               .geometry_inside = cell.geometry_inside,
               .interior_share = how.interior_share,
               .player_radius = how.player_radius},
              cell.grown, cell.free),
      limit_(cell.limit ? cell.limit->part(1.0) : time_limit(0.0, true)) {}

void guided_search::join(const std::vector<followed>& wave) {
  found_.clear();
  for (const followed& one : wave) {
    spent_ += one.rays;
    found_.insert(found_.end(), one.found.begin(), one.found.end());
  }
  std::vector<seed_ray> seed_rays = join_finds(rays_, {how_.player_radius, how_.smallest_gap}, found_, set_);
  waiting_.insert(waiting_.end(), seed_rays.begin(), seed_rays.end());
}

void guided_search::look_at_random() {
  const std::uint64_t wanted = std::min<std::uint64_t>(how_.rays_per_round, left());
  for (std::uint64_t done = 0; done < wanted && !limit_.reached();) {
    const std::uint64_t rays = std::min(wanted - done, rays_of_wave);
    const std::uint64_t first = done / random_rays::stretch;
    std::vector<followed> wave((rays + random_rays::stretch - 1) / random_rays::stretch);
    tbb::parallel_for(std::size_t{0}, wave.size(), [&](std::size_t i) {
      std::vector<random_ray> drawn;
      random_.draw(round_, first + i, drawn);
      noting_rays caster(rays_, set_);
      const std::uint64_t count = std::min<std::uint64_t>(drawn.size(), rays - i * random_rays::stretch);
      for (std::size_t k = 0; k < count; ++k) caster.cast(drawn[k].eye, drawn[k].direction, true, wave[i].found);
      wave[i].rays = count;
    });
    join(wave);
    done += rays;
  }
  ++round_;
}

void guided_search::follow_all(
    std::uint64_t most, const std::function<void(const seed_ray& from, noting_rays& rays, followed& out)>& follow) {
  constexpr std::size_t stretch = 8;
  const std::size_t together = std::max<std::uint64_t>(rays_of_wave / most, stretch);
  // First in, first out: seed rays of a wave are followed after all that were queued before.
  std::size_t next = 0;
  while (next < waiting_.size() && !limit_.reached()) {
    const std::size_t count = std::min<std::uint64_t>({together, waiting_.size() - next, left() / most});
    if (count == 0) break;
    std::vector<followed> wave((count + stretch - 1) / stretch);
    tbb::parallel_for(std::size_t{0}, wave.size(), [&](std::size_t i) {
      noting_rays caster(rays_, set_);
      const std::size_t end = std::min(count, (i + 1) * stretch);
      for (std::size_t k = i * stretch; k < end; ++k) follow(waiting_[next + k], caster, wave[i]);
    });
    next += count;
    join(wave);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(next));
}

}  // namespace sightcell::bake
