#include "search/found_before.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <initializer_list>
#include <limits>
#include <utility>

#include "search/aim.h"
#include "search/neighbor_check.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t task_size = 64;  // rays per task
// Rays at an edit are cast in rounds, until one finds next to nothing.
constexpr std::size_t rays_of_round = 2048, next_to_nothing = 4;
constexpr std::uint64_t most_rounds = 8;

bool overlap(const box& a, const box& b) {
  return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

box around(std::span<const edited_part> parts) {
  box all{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
  for (const edited_part& part : parts) all = {glm::min(all.min, part.where.min), glm::max(all.max, part.where.max)};
  return all;
}

triangle_tree tree_of(std::initializer_list<const std::vector<edited_part>*> parts, float smallest_gap) {
  std::vector<triangle> all;
  for (const auto* list : parts)
    for (const edited_part& part : *list) all.insert(all.end(), part.corners.begin(), part.corners.end());
  return {std::move(all), reach_beside(smallest_gap)};
}

// Returns whether what was added may occlude all of the triangle from the eye: the lines to its corners and its center
// pass it.
bool may_occlude(const triangle_tree& added, const glm::vec3& eye, const triangle& corners) {
  const auto passes = [&](const glm::vec3& to) { return added.passes(eye, to - eye, 1.0f); };
  return !added.empty() && passes((corners[0] + corners[1] + corners[2]) / 3.0f) &&
         std::all_of(corners.begin(), corners.end(), passes);
}

std::vector<std::uint8_t> valid_witnesses(const ray_scene& rays, const found_before& before,
                                          const visibility_rules& rules, std::uint64_t& tested) {
  const std::vector<glm::vec3>& eyes = before.record.witnesses;
  std::vector<std::uint8_t> valid(eyes.size(), 1);
  std::vector<glm::vec3> near;
  std::vector<std::size_t> which;
  const box reached = before.edit->around_added.grown(rules.player_radius + rules.smallest_gap);
  for (std::size_t i = 0; i < eyes.size(); ++i)
    if (!before.edit->added.empty() && overlap(reached, {eyes[i], eyes[i]}))
      near.push_back(eyes[i]), which.push_back(i);
  std::vector<std::uint8_t> of_near(near.size());
  rays.find_valid(near, rules.player_radius, of_near);
  for (std::size_t i = 0; i < near.size(); ++i) valid[which[i]] = of_near[i];
  tested += near.size();
  return valid;
}

// The triangles of an edit, to be chosen at random: each alike, which finds small ones, or by area, which finds what
// large ones occluded.
class targets {
 public:
  explicit targets(const edited_triangles& edit) {
    for (const auto* parts : {&edit.removed, &edit.added})
      for (const edited_part& part : *parts)
        for (const triangle& t : part.corners) {
          all_.push_back(&t);
          area_ += 0.5 * static_cast<double>(glm::length(glm::cross(t[1] - t[0], t[2] - t[0])));
          area_up_to_.push_back(area_);
        }
  }

  bool empty() const { return all_.empty(); }
  const triangle& any(random_stream& random) const { return *all_[random.bits() % all_.size()]; }
  const triangle& by_area(random_stream& random) const {
    const auto at = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), random.uniform() * area_);
    return at == area_up_to_.end() ? *all_.back() : *all_[static_cast<std::size_t>(at - area_up_to_.begin())];
  }

 private:
  std::vector<const triangle*> all_;
  std::vector<double> area_up_to_;  // of each with those before it
  double area_ = 0.0;
};

// Casts a round of rays from eyes of the set at the edit. Returns the polygons that the set lacks, in an order that
// does not depend on threads.
std::vector<found_polygon> found_at(const targets& edit, const ray_scene& rays, const neighbor_check_settings& how,
                                    std::uint64_t name, const cell_set& set) {
  const std::vector<glm::vec3>& eyes = set.eyes();
  std::vector<std::vector<found_polygon>> found(rays_of_round / task_size);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    aimed_rays aimed(rays, how.rules.smallest_gap, set);
    for (std::size_t i = k * task_size; i < (k + 1) * task_size; ++i) {
      random_stream random(how.seed, how.place, how.use, name, mix_bits(i));
      const triangle& at = i % 2 == 0 ? edit.any(random) : edit.by_area(random);
      const glm::vec3& eye = eyes[random.bits() % eyes.size()];
      (void)aimed.aim(eye, random_point(at, random), no_polygon, found[k]);
    }
  });
  std::vector<found_polygon> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

edited_triangles::edited_triangles(std::vector<edited_part> gone, std::vector<edited_part> made, float smallest_gap)
    : removed(std::move(gone)),
      added(std::move(made)),
      all(tree_of({&removed, &added}, smallest_gap)),
      of_added(tree_of({&added}, smallest_gap)),
      around_added(around(added)) {}

double share_left(std::span<const triangle> corners, const found_before& before, std::size_t members) {
  const cell_record& record = before.record;
  std::size_t left = record.set.size();
  for (std::size_t i = 0; i < record.set.size(); ++i)
    left -=
        may_occlude(before.edit->of_added, record.witnesses[record.witness_of[i]], corners[record.set[i]]) ? 1u : 0u;
  return static_cast<double>(left) / static_cast<double>(std::max<std::size_t>(members, 1));
}

std::uint64_t join_found_before(const ray_scene& rays, const found_before& before, const visibility_rules& rules,
                                cell_set& set) {
  const cell_record& record = before.record;
  std::uint64_t tested = 0;
  const std::vector<std::uint8_t> valid = valid_witnesses(rays, before, rules, tested);
  std::vector<std::uint8_t> keep(record.set.size());
  for (std::size_t i = 0; i < record.set.size(); ++i) {
    const std::uint32_t witness = record.witness_of[i], polygon = record.set[i];
    keep[i] = valid[witness] && !set.contains(polygon) &&
              !may_occlude(before.edit->of_added, record.witnesses[witness], corners_of(rays.geometry(), polygon));
  }
  set.add_members(record, keep);
  return tested;
}

std::uint64_t look_again(const ray_scene& rays, const box& grown, const found_before& before,
                         const neighbor_check_settings& how, cell_set& set) {
  return set.eyes().empty() ? 0 : neighbor_check(rays, grown, how, {&before.record, 1}, set);
}

std::uint64_t look_at_edit(const ray_scene& rays, const found_before& before, const neighbor_check_settings& how,
                           cell_set& set) {
  const targets edit(*before.edit);
  if (edit.empty() || set.eyes().empty()) return 0;
  const finding by_rays(set, found_by::nearby_rays);
  for (std::uint64_t round = 1; round <= most_rounds; ++round) {
    const std::size_t known = set.members().size();
    for (const found_polygon& f : found_at(edit, rays, how, most_rounds * before.record.batches + round, set))
      set.add(f.polygon, f.eye);
    if (set.members().size() <= known + next_to_nothing || (how.limit && how.limit->reached()))
      return round * rays_of_round;
  }
  return most_rounds * rays_of_round;
}

std::optional<cast_again> bound_before(const ray_scene& rays, const found_before& before, float smallest_gap,
                                       const cell_set& set) {
  // Where the rays of a bound are cast again in vain, the next batch has half of the confidence that it had, and needs
  // ln 2 / target rays more. Those of the last number need three times as many as a first batch.
  constexpr std::uint32_t last_number = 12;
  const cell_record& record = before.record;
  if (!record.bound_met || record.of_bound.number == 0 || record.of_bound.number > last_number) return std::nullopt;
  std::vector<triangle> left_out;
  for (const std::uint32_t polygon : record.set)
    if (!set.contains(polygon)) left_out.push_back(corners_of(rays.geometry(), polygon));
  return cast_again{record.of_bound,   record.rays,
                    record.misses,     record.confidence,
                    &before.edit->all, triangle_tree(std::move(left_out), reach_beside(smallest_gap))};
}

}  // namespace sightcell::bake
