#include "sampler/ray_finds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <tuple>

#include "search/aim.h"
#include "sightcell/base/random.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

// Number of rays that are tested per polygon and wave if they start at invalid viewpoints or pass light leaks.
// Without a limit a floor under the solid half of a cell would cost 64 rays for each ray that hit it.
constexpr std::size_t tries_per_polygon = 8;

// A find with its sort key. Of several rays that found a polygon a random one comes first. If it were the one from
// the lowest viewpoint, all later rays would start in one corner of the cell.
struct ordered_find {
  std::uint64_t name;     // of the polygon's position
  std::uint32_t polygon;  // distinguishes exact duplicates only
  std::uint64_t of_ray;
  const ray_find* find;
  bool operator<(const ordered_find& other) const {
    return std::tie(name, polygon, of_ray) < std::tie(other.name, other.polygon, other.of_ray);
  }
};

std::uint64_t name_of_ray(const ray_find& find) {
  std::uint64_t name = 0;
  for (const glm::vec3& part : {find.eye, find.direction})
    for (int axis = 0; axis < 3; ++axis) name = mix_bits(name ^ std::bit_cast<std::uint32_t>(part[axis] + 0.0f));
  // Eyes that are known to be valid come first: they need no test.
  return name >> 1 | (find.eye_is_free ? 0 : std::uint64_t{1} << 63);
}

// The result for one polygon.
struct tested {
  const ray_find* by = nullptr;  // null: not visible by the rules
  std::vector<std::uint32_t> same_place;
};

tested test(const ray_scene& rays, const visibility_rules& rules, const ordered_find* first, const ordered_find* end) {
  tested result;
  end = std::min(end, first + tries_per_polygon);
  for (; first != end; ++first) {
    const ray_find& f = *first->find;
    if (!f.eye_is_free && !rays.is_valid(f.eye, rules.player_radius)) continue;
    if (rays.through_gap(f.eye, f.direction, f.distance, rules.smallest_gap)) continue;
    result.by = &f;
    rays.coincident(f.eye, f.direction, f.distance, result.same_place);
    break;
  }
  return result;
}

}  // namespace

const sight& noting_rays::cast(const glm::vec3& eye, const glm::vec3& direction, bool eye_is_free,
                               std::vector<ray_find>& found) {
  rays_.trace(eye, direction, seen_);
  const auto note = [&](std::uint32_t polygon, float distance) {
    if (polygon != no_polygon && !set_.contains(polygon))
      found.push_back({polygon, eye, direction, distance, eye_is_free});
  };
  note(seen_.front, seen_.distance);
  for (const passed_polygon& p : seen_.before) note(p.polygon, p.distance);
  return seen_;
}

std::vector<seed_ray> join_finds(const ray_scene& rays, const visibility_rules& rules, std::vector<ray_find>& found,
                                 cell_set& set) {
  constexpr std::size_t stretch = 64;
  std::vector<ordered_find> ordered(found.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      ordered[i] = {name_of(corners_of(rays.geometry(), found[i].polygon)), found[i].polygon, name_of_ray(found[i]),
                    &found[i]};
  });
  tbb::parallel_sort(ordered.begin(), ordered.end());
  std::vector<const ordered_find*> firsts;  // first find of each polygon, and the end
  for (std::size_t i = 0; i < ordered.size(); ++i)
    if (i == 0 || ordered[i].polygon != ordered[i - 1].polygon) firsts.push_back(&ordered[i]);
  firsts.push_back(ordered.data() + ordered.size());

  std::vector<tested> outcomes(firsts.size() - 1);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, outcomes.size(), stretch), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) outcomes[i] = test(rays, rules, firsts[i], firsts[i + 1]);
  });

  std::vector<seed_ray> seed_rays;
  const auto join = [&](std::uint32_t polygon, const ray_find& by) {
    if (set.add(polygon, by.eye)) seed_rays.push_back({polygon, by.eye, by.eye + by.direction * by.distance});
  };
  // Polygons that were hit join before those that coincide with them, so that seed rays do not depend on ids.
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (outcomes[i].by) join(firsts[i]->polygon, *outcomes[i].by);
  for (tested& outcome : outcomes) {
    std::sort(outcome.same_place.begin(), outcome.same_place.end(), [&](std::uint32_t a, std::uint32_t b) {
      return name_of(corners_of(rays.geometry(), a)) < name_of(corners_of(rays.geometry(), b));
    });
    for (const std::uint32_t polygon : outcome.same_place) join(polygon, *outcome.by);
  }
  return seed_rays;
}

}  // namespace sightcell::bake
