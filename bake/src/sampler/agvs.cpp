#include "sampler/agvs.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>
#include <utility>

#include "sightcell/base/process_time.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t pool_size = 1 << 17;  // mutation candidates
// Rounds double until they have --rays-per-round, because in the beginning every ray of a round finds the same
// polygons.
constexpr std::uint64_t first_round = 1024;
constexpr std::uint64_t chunk_rays = 512;

auto key(const glm::vec3& v) {
  return std::tie(v.x, v.y, v.z);
}

std::vector<std::uint32_t> by_place(std::span<const view_cell> cells) {
  std::vector<std::uint32_t> order(cells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(cells[a].place, a) < std::pair(cells[b].place, b);
  });
  return order;
}

std::vector<std::uint64_t> places_of(std::span<const view_cell> cells) {
  std::vector<std::uint64_t> places;
  for (const std::uint32_t cell : by_place(cells)) places.push_back(cells[cell].place);
  return places;
}

std::vector<box> boxes_of(std::span<const view_cell> cells, float grown_by) {
  std::vector<box> boxes;
  for (const std::uint32_t cell : by_place(cells))
    boxes.push_back(box{cells[cell].min, cells[cell].max}.grown(grown_by));
  return boxes;
}

float distance(const box& a, const box& b) {
  return glm::length(glm::max(glm::max(a.min - b.max, b.min - a.max), glm::vec3{0.0f}));
}

// Orders candidates: least used first, of equals the newest.
bool goes_before(const mutation_candidate& a, const mutation_candidate& b) {
  return a.uses != b.uses ? a.uses < b.uses : a.number > b.number;
}

}  // namespace

agvs::agvs(const settings& how, const sampler_world& world)
    : how_(how),
      world_(world),
      places_(places_of(world.cells)),
      cells_(boxes_of(world.cells, 0.0f)),
      grown_(boxes_of(world.cells, how.margin)),
      rays_(world.rays, grown_.boxes()),
      known_(world.cells.size()),
      memory_(world.cells.size()) {}

std::uint64_t agvs::pairs() const {
  std::uint64_t sum = 0;
  for (const seen_pairs& one : known_) sum += one.all().size();
  return sum;
}

agvs::round_plan agvs::plan_round(std::uint64_t rays) {
  round_plan plan;
  const std::uint64_t mutable_rays = pool_.empty() ? 0 : rays;
  plan.counts = shares_.rays_of_round(rays, {rays, rays, rays, mutable_rays, mutable_rays, blocked_.size()});
  const std::uint64_t wanted =
      plan.counts[std::size_t(ray_kind::mutation)] + plan.counts[std::size_t(ray_kind::silhouette)];
  if (wanted == 0) return plan;
  const std::size_t used = std::min<std::size_t>(wanted, pool_.size());
  std::nth_element(pool_.begin(), pool_.begin() + static_cast<std::ptrdiff_t>(used - 1), pool_.end(), goes_before);
  std::sort(pool_.begin(), pool_.begin() + static_cast<std::ptrdiff_t>(used), goes_before);
  for (std::uint64_t i = 0; i < wanted; ++i) {
    // Mutations and silhouettes both iterate over all candidates.
    const auto which = static_cast<std::uint32_t>(i % used);
    plan.candidates.push_back(which);
    ++pool_[which].uses;
  }
  return plan;
}

// Returns the kind of ray i. i becomes its index among the rays of that kind.
ray_kind agvs::kind_of(const round_plan& plan, std::uint64_t& i) {
  std::size_t kind = 0;
  while (i >= plan.counts[kind]) i -= plan.counts[kind++];
  return static_cast<ray_kind>(kind);
}

global_ray agvs::ray_of(const round_plan& plan, std::uint64_t i, random_stream& numbers) const {
  switch (kind_of(plan, i)) {
    case ray_kind::random:
      return rays_.random(numbers);
    case ray_kind::object:
      return rays_.object(numbers);
    case ray_kind::two_point:
      return rays_.two_point(numbers);
    case ray_kind::mutation:
      return rays_.mutation(pool_[plan.candidates[i]], numbers);
    case ray_kind::silhouette:
      return rays_.silhouette(pool_[plan.candidates[plan.counts[std::size_t(ray_kind::mutation)] + i]], numbers);
    default:
      // The newest ones: rays at the end belong to kinds that found most recently.
      return rays_.reverse(blocked_[blocked_.size() - 1 - i], numbers);
  }
}

feed_finds agvs::cast(const round_plan& plan) const {
  const std::uint64_t rays = std::accumulate(plan.counts.begin(), plan.counts.end(), std::uint64_t{0});
  std::vector<feed_finds> chunks((rays + chunk_rays - 1) / chunk_rays);
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t chunk) {
    ray_feed feed(world_.rays, grown_, places_, known_, memory_,
                  {how_.player_radius, how_.smallest_gap, how_.seed, round_});
    const std::uint64_t end = std::min(rays, (chunk + 1) * chunk_rays);
    for (std::uint64_t i = chunk * chunk_rays; i < end; ++i) {
      random_stream numbers(how_.seed, 0, purpose::agvs, round_, i);
      feed.cast(ray_of(plan, i, numbers), i);
    }
    chunks[chunk] = feed.take();
  });
  feed_finds all;
  for (const feed_finds& chunk : chunks) {
    all.found.insert(all.found.end(), chunk.found.begin(), chunk.found.end());
    all.blocked.insert(all.blocked.end(), chunk.blocked.begin(), chunk.blocked.end());
    all.asked.insert(all.asked.end(), chunk.asked.begin(), chunk.asked.end());
  }
  return all;
}

// If several rays of this round found a pair, it goes to the one with the lowest eye.
std::uint64_t agvs::merge(const round_plan& plan, feed_finds& finds) {
  tbb::parallel_sort(finds.found.begin(), finds.found.end(), [](const found_pair& a, const found_pair& b) {
    return std::tuple(a.cell, a.polygon, key(a.eye), a.ray) < std::tuple(b.cell, b.polygon, key(b.eye), b.ray);
  });
  std::vector<found_pair> joined;
  for (const found_pair& f : finds.found)
    if (known_[f.cell].add(f.polygon, f.eye)) joined.push_back(f);

  std::array<std::uint64_t, ray_kinds> pairs{};
  for (const found_pair& f : joined) {
    std::uint64_t i = f.ray;
    ++pairs[std::size_t(kind_of(plan, i))];
  }
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    shares_.found(static_cast<ray_kind>(kind), plan.counts[kind], pairs[kind]);
    results_[kind].rays += plan.counts[kind];
    results_[kind].pairs += pairs[kind];
  }
  for (const place_asked& one : finds.asked) memory_.note(one.cell, one.part, one.free);
  make_candidates(joined);
  blocked_ = std::move(finds.blocked);
  return joined.size();
}

// Makes one candidate per polygon that a ray found, for any number of cells to which it was new.
void agvs::make_candidates(std::vector<found_pair>& joined) {
  std::sort(joined.begin(), joined.end(), [](const found_pair& a, const found_pair& b) {
    return std::tuple(a.ray, key(a.point), key(a.eye)) < std::tuple(b.ray, key(b.point), key(b.eye));
  });
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const found_pair& f = joined[i];
    if (i > 0 && joined[i - 1].ray == f.ray && joined[i - 1].polygon == f.polygon) continue;
    pool_.push_back({f.eye, f.point, f.polygon, 0, ++made_});
  }
  if (pool_.size() <= pool_size) return;
  std::nth_element(pool_.begin(), pool_.begin() + pool_size, pool_.end(), goes_before);
  pool_.resize(pool_size);
}

void agvs::prepare(const std::function<bool(double share)>& go_on) {
  const double began = process_cpu_seconds();
  if (!rays_.find_viewpoints(how_.player_radius, how_.seed, places_)) return;
  const std::uint64_t budget = how_.sampling_rays * known_.size();
  const double seconds = how_.seconds_per_cell * static_cast<double>(known_.size());
  while (spent_ < budget) {
    if (!go_on(static_cast<double>(spent_) / static_cast<double>(budget))) return;
    const std::uint64_t rays = std::min<std::uint64_t>(how_.rays_per_round, first_round << std::min(round_, 20ul));
    const round_plan plan = plan_round(std::min(rays, budget - spent_));
    feed_finds finds = cast(plan);
    const std::uint64_t joined = merge(plan, finds);
    spent_ += std::accumulate(plan.counts.begin(), plan.counts.end(), std::uint64_t{0});
    ++round_;
    if (rays >= how_.rays_per_round && joined < std::uint64_t{how_.fewest_new} * known_.size()) break;
    if (seconds > 0.0 && process_cpu_seconds() - began >= seconds) break;
  }
}

sampling_effort agvs::sample(const sampled_cell& cell, cell_set& set) const {
  const auto index =
      static_cast<std::size_t>(std::lower_bound(places_.begin(), places_.end(), cell.place) - places_.begin());
  for (const seen_pairs::pair& p : known_[index].all()) set.add(p.polygon, p.eye);
  if (how_.filter > 0.0)
    for (std::size_t near = 0; near < cells_.size(); ++near) {
      if (static_cast<double>(distance(cells_[index], cells_[near])) > how_.filter) continue;
      for (const seen_pairs::pair& p : known_[near].all()) set.add(p.polygon, cell.free.front());
    }
  return {.rays = spent_ / known_.size()};
}

}  // namespace sightcell::bake
