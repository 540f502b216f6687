#include "search/refinement.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>
#include <tuple>

#include "cell_set/point_order.h"
#include "search/aim.h"
#include "trace/direction_code.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// The first ray comes from where a polygon beside the target was seen, later ones from anywhere. Of 20 million rays in
// intel_castle 17 of 100 first ones hit, 1.2 of 100 second ones and 0.5 of 100 third ones; of 13 million in temple 1.1,
// 0.10 and 0.05. So later rays are for large targets, and for cells that need many rounds. A cell of temple takes 0.88
// of the time that it takes with 1/16, and one of intel_castle 0.93. Where the first ones rarely hit there are no later
// ones (docs/method/notes.md).
constexpr float priority_after_miss = 0x1p-10f;
constexpr std::uint32_t most_misses = 8;

// Returns the number of halvings from the largest priority, the index of the level.
std::size_t level_of(float priority, std::size_t count) {
  if (!(priority > 0.0f)) return count - 1;
  const float below = std::log2(largest_solid_angle / priority);
  return std::min(static_cast<std::size_t>(std::max(below, 0.0f)), count - 1);
}

}  // namespace

refinement::refinement(const ray_scene& rays, const near_polygons& neighbors, const refinement_settings& how,
                       cell_set& set)
    : rays_(rays), neighbors_(neighbors), how_(how), set_(set), taken_(how.tried > 0.0 ? 0 : how.known) {}

void refinement::push(const attempt& one) {
  levels_[level_of(one.priority, level_count)].push_back(one);
}

bool refinement::done() const {
  return taken_ == set_.members().size() &&
         std::all_of(levels_.begin(), levels_.end(), [](const auto& level) { return level.empty(); });
}

// Lowers the priority of a try to where an earlier search stopped. Returns false if no ray is left for it.
bool refinement::leave_tried(attempt& one) const {
  const std::size_t last = level_of(static_cast<float>(how_.tried), level_count);
  while (one.misses < most_misses && level_of(one.priority, level_count) <= last) {
    ++one.misses;
    one.priority *= priority_after_miss;
  }
  return one.misses < most_misses;
}

void refinement::take_members() {
  constexpr std::size_t stretch = 64;
  const std::size_t first = taken_, end = set_.members().size();
  taken_ = end;
  std::vector<std::vector<attempt>> found((end - first + stretch - 1) / stretch);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    if (stopped()) return;
    std::vector<std::uint32_t> near;
    for (std::size_t i = first + k * stretch; i < std::min(end, first + (k + 1) * stretch); ++i) {
      const std::uint32_t member = set_.members()[i];
      const glm::vec3 eye = set_.witness(member);
      near.clear();
      neighbors_.for_each(member, [&](std::uint32_t neighbor) {
        if (!set_.contains(neighbor)) near.push_back(neighbor);
      });
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (const std::uint32_t neighbor : near) {
        const triangle corners = corners_of(rays_.geometry(), neighbor);
        if (!rays_.sees_both_sides(neighbor) && !is_in_front(eye, corners)) continue;  // not visible from this eye
        const float size = solid_angle(corners, eye);
        attempt one{neighbor, member, std::min(size, how_.largest_priority), 0};
        if (i >= how_.known || leave_tried(one)) found[k].push_back(one);
      }
    }
  });
  for (const auto& part : found)
    for (const attempt& one : part) push(one);
}

std::uint64_t refinement::run(double priority, std::uint64_t max_rays) {
  std::uint64_t cast = 0;
  take_members();
  const std::size_t last = level_of(static_cast<float>(priority), level_count);
  for (std::size_t level = 0; level <= last;) {
    if (levels_[level].empty()) {
      ++level;
      continue;
    }
    if (cast >= max_rays || over()) break;
    std::vector<attempt> wave;
    wave.swap(levels_[level]);
    cast += run_wave(wave);
    take_members();
    // Neighbors of what joined may have a higher priority than this level.
    level = 0;
  }
  return cast;
}

// Returns a viewpoint that the target faces. If a few random ones are behind it, returns the witness of the member.
glm::vec3 refinement::eye_of(const attempt& one, random_stream& random) const {
  constexpr int draws = 4;
  for (int i = 0; one.misses > 0 && how_.viewpoints && !how_.viewpoints->empty() && i < draws; ++i) {
    const glm::vec3& eye = (*how_.viewpoints)[random.bits() % how_.viewpoints->size()];
    if (faces(rays_, one.target, eye)) return eye;
  }
  return set_.witness(one.member);
}

// Sorts rays so that those of a packet have the same origin and similar directions.
std::vector<refinement::aimed_try> refinement::aim(const std::vector<attempt>& tries) const {
  std::vector<aimed_try> aimed(tries.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tries.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const attempt& one = tries[i];
      const triangle corners = corners_of(rays_.geometry(), one.target);
      aimed_try& ray = aimed[i];
      ray.which = static_cast<std::uint32_t>(i);
      ray.name = name_of(corners_of(rays_.geometry(), one.member)) - name_of(corners);
      random_stream random(how_.seed, how_.place, how_.use, one.misses, ray.name);
      ray.line.eye = eye_of(one, random);
      const glm::vec3 toward = random_point(corners, random) - ray.line.eye;
      ray.length = glm::length(toward);
      ray.line.direction = ray.length > 0.0f ? toward / ray.length : glm::vec3{0.0f, 1.0f, 0.0f};
      ray.code = direction_code(ray.line.direction);
    }
  });
  tbb::parallel_sort(aimed.begin(), aimed.end(), [](const aimed_try& a, const aimed_try& b) {
    if (a.line.eye != b.line.eye) return is_lower(a.line.eye, b.line.eye);
    return std::tie(a.code, a.name) < std::tie(b.code, b.name);
  });
  return aimed;
}

// Casts one ray per target of the wave, for the member with the fewest misses. The other tries wait for the next
// wave.
std::uint64_t refinement::run_wave(std::vector<attempt>& wave) {
  wave.erase(std::remove_if(wave.begin(), wave.end(), [&](const attempt& one) { return set_.contains(one.target); }),
             wave.end());
  // The order of targets has no effect, but the choice among the tries of a target must not depend on ids.
  tbb::parallel_sort(wave.begin(), wave.end(), [&](const attempt& a, const attempt& b) {
    if (a.target != b.target) return a.target < b.target;
    if (a.misses != b.misses) return a.misses < b.misses;
    if (a.priority != b.priority) return a.priority > b.priority;
    const glm::vec3 &from_a = set_.witness(a.member), &from_b = set_.witness(b.member);
    if (from_a != from_b) return is_lower(from_a, from_b);
    return name_of(corners_of(rays_.geometry(), a.member)) < name_of(corners_of(rays_.geometry(), b.member));
  });
  std::vector<attempt> now;
  for (std::size_t i = 0; i < wave.size(); ++i) {
    if (i == 0 || wave[i].target != wave[i - 1].target)
      now.push_back(wave[i]);
    else
      push(wave[i]);
  }

  const bool try_later = !rarely_hits();
  const std::vector<aimed_try> aimed = aim(now);
  constexpr std::size_t stretch = 256;
  struct outcome {
    std::vector<found_polygon> found;
    std::vector<attempt> missed;
    std::uint64_t first_tries = 0, first_hits = 0;
  };
  std::vector<outcome> outcomes((aimed.size() + stretch - 1) / stretch);
  tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t k) {
    if (stopped()) return;  // the next call of over() throws
    aimed_rays caster(rays_, how_.smallest_gap, set_);
    const std::size_t first = k * stretch, count = std::min(aimed.size() - first, stretch);
    std::array<sight_line, stretch> lines;
    std::vector<sight> seen(count);
    for (std::size_t i = 0; i < count; ++i) lines[i] = aimed[first + i].line;
    rays_.trace(std::span(lines).first(count), seen);
    for (std::size_t i = 0; i < count; ++i) {
      const aimed_try& ray = aimed[first + i];
      attempt one = now[ray.which];
      const bool hit = ray.length > 0.0f && caster.take(ray.line, seen[i], ray.length, one.target, outcomes[k].found);
      if (one.misses == 0) {
        ++outcomes[k].first_tries;
        outcomes[k].first_hits += hit ? 1 : 0;
      }
      if (hit || !try_later || ++one.misses == most_misses) continue;
      one.priority *= priority_after_miss;
      outcomes[k].missed.push_back(one);
    }
  });

  std::vector<found_polygon> found;
  for (const outcome& o : outcomes) {
    found.insert(found.end(), o.found.begin(), o.found.end());
    for (const attempt& one : o.missed) push(one);
    first_tries_ += o.first_tries;
    first_hits_ += o.first_hits;
  }
  // Of several eyes that found a polygon in this wave the lowest becomes its witness, so that the choice does not
  // depend on ids.
  std::sort(found.begin(), found.end());
  const finding rays(set_, found_by::nearby_rays);
  for (const found_polygon& f : found) set_.add(f.polygon, f.eye);
  return now.size();
}

}  // namespace sightcell::bake
