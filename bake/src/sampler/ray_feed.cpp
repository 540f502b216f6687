#include "sampler/ray_feed.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>
#include <utility>

#include "sightcell/base/random.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr float before_aim = 0.99f;  // share of the way; a hit before that blocks the ray
// Share of viewpoints that are still tested in a part of a cell that seems to be a wall.
constexpr float barren_share = 0.0625f;

}  // namespace

// Finds the closest polygon that occludes when both sides do, and the non-occluders before it. Returns whether its
// back was hit.
// way: 1 along the ray, -1 against it.
bool ray_feed::meets_back(const global_ray& ray, float way, float& clear) {
  rays_.trace_both_sides(ray.origin, ray.direction * way, seen_);
  clear = way * seen_.distance;
  for (const passed_polygon& p : seen_.before) things_.push_back({p.polygon, way * p.distance});
  if (seen_.front == no_polygon) return false;
  if (!faces(rays_, seen_.front, ray.origin)) return true;
  things_.push_back({seen_.front, clear});
  return false;
}

// Continues the line through a back face, which does not occlude.
float ray_feed::trace_on(const global_ray& ray, float way, float clear) {
  rays_.trace(ray.origin, ray.direction * way, seen_);
  for (const passed_polygon& p : seen_.before)
    if (p.distance > std::abs(clear)) things_.push_back({p.polygon, way * p.distance});
  if (seen_.front != no_polygon) things_.push_back({seen_.front, way * seen_.distance});
  return way * seen_.distance;
}

// Returns false if the ray contributes nothing.
bool ray_feed::trace(const global_ray& ray) {
  things_.clear();
  const bool back_ahead = meets_back(ray, 1.0f, clear_to_), back_behind = meets_back(ray, -1.0f, clear_from_);
  // Backs on both sides: the line is in a solid. A valid viewpoint has backs in at most a tenth of the directions.
  if (back_ahead && back_behind) return false;
  to_ = back_ahead ? trace_on(ray, 1.0f, clear_to_) : clear_to_;
  from_ = back_behind ? trace_on(ray, -1.0f, clear_from_) : clear_from_;
  return !things_.empty();
}

void ray_feed::note_new(const global_ray& ray, const crossing& through, float at, std::uint64_t number,
                        std::vector<found_pair>& found) {
  const glm::vec3 eye = ray.origin + ray.direction * at;
  for (const thing& t : things_) {
    const bool ahead = at < t.at;
    if (ahead ? at < clear_from_ : at > clear_to_) continue;
    if (known_[through.cell].contains(t.polygon) || !faces(rays_, t.polygon, eye)) continue;
    const glm::vec3 direction = ahead ? ray.direction : -ray.direction;
    if (rays_.through_gap(eye, direction, std::abs(t.at - at), rules_.smallest_gap)) continue;
    found.push_back({through.cell, t.polygon, eye, ray.origin + ray.direction * t.at, number});
  }
}

void ray_feed::cast(const global_ray& ray, std::uint64_t number) {
  if (ray.direction == glm::vec3{0.0f} || !trace(ray)) return;
  if (ray.polygon != no_polygon && clear_to_ < before_aim * glm::length(ray.aim - ray.origin)) {
    const auto hit = std::find_if(things_.begin(), things_.end(), [&](const thing& t) { return t.at == clear_to_; });
    if (hit != things_.end() && hit->polygon != ray.polygon)
      finds_.blocked.push_back({ray.origin, ray.point, ray.aim, ray.origin + ray.direction * clear_to_, hit->polygon});
  }
  const float from = from_ + rules_.player_radius, to = to_ - rules_.player_radius;  // no viewpoint beyond is valid
  if (!(from < to)) return;
  cells_.find(ray.origin, ray.direction, from, to, crossed_);
  for (const crossing& through : crossed_) {
    const bool at_origin = ray.origin_is_free && through.from <= 0.0f && through.to >= 0.0f;
    random_stream numbers(rules_.seed, places_[through.cell], purpose::agvs_place, rules_.round, number);
    const float at = at_origin ? 0.0f : through.from + (through.to - through.from) * numbers.uniform();
    if (at_origin) {
      note_new(ray, through, at, number, finds_.found);
      continue;
    }
    const glm::vec3 eye = ray.origin + ray.direction * at;
    const std::uint32_t part = free_memory::part_of(cells_.boxes()[through.cell], eye);
    if (memory_.is_barren(through.cell, part) && numbers.uniform() >= barren_share) continue;
    const std::size_t before = new_.size();
    note_new(ray, through, at, number, new_);
    if (new_.size() == before) continue;
    eyes_.push_back(eye);
    asked_.push_back({through.cell, part});
    ends_.push_back(new_.size());
  }
}

feed_finds ray_feed::take() {
  // Tests neighboring viewpoints in one packet, since the 64 rays of each have the same directions.
  std::vector<std::uint32_t> order(eyes_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(asked_[a].cell, asked_[a].part, a) < std::tie(asked_[b].cell, asked_[b].part, b);
  });
  std::vector<glm::vec3> sorted;
  for (const std::uint32_t i : order) sorted.push_back(eyes_[i]);
  std::vector<std::uint8_t> free(sorted.size());
  rays_.find_valid(sorted, rules_.player_radius, free);
  for (std::size_t k = 0; k < order.size(); ++k) asked_[order[k]].free = free[k] != 0;
  for (std::size_t i = 0, first = 0; i < asked_.size(); first = ends_[i++])
    if (asked_[i].free)
      finds_.found.insert(finds_.found.end(), new_.begin() + static_cast<std::ptrdiff_t>(first),
                          new_.begin() + static_cast<std::ptrdiff_t>(ends_[i]));
  finds_.asked = std::move(asked_);
  new_.clear(), eyes_.clear(), asked_.clear(), ends_.clear();
  return std::exchange(finds_, {});
}

}  // namespace sightcell::bake
