#include "search/found_before.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "search/aim.h"
#include "search/neighbor_check.h"
#include "trace/line_box.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t task_size = 64;  // rays per task
// Rays at an edit are cast in rounds, until one finds next to nothing.
constexpr std::size_t rays_of_round = 2048, next_to_nothing = 4;
constexpr std::uint64_t most_rounds = 8;
constexpr std::size_t most_parts_for_lines = 256;  // with more, lines are compared with the box of all alone

bool overlap(const box& a, const box& b) {
  return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

box around(std::span<const edited_part> parts) {
  box all{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
  for (const edited_part& part : parts) all = {glm::min(all.min, part.where.min), glm::max(all.max, part.where.max)};
  return all;
}

// Where something was added.
class additions {
 public:
  additions(std::span<const edited_part> parts, float near)
      : parts_(parts), near_(near), all_(around(parts).grown(near)) {}

  bool reach(const glm::vec3& eye) const { return !parts_.empty() && overlap(all_, {eye, eye}); }
  // Returns whether what was added may occlude all of the triangle from the eye: the lines to its corners and its
  // center pass it.
  bool may_occlude(const glm::vec3& eye, const triangle& corners) const {
    if (parts_.empty()) return false;
    const glm::vec3 center = (corners[0] + corners[1] + corners[2]) / 3.0f;
    return pass(eye, center) &&
           std::all_of(corners.begin(), corners.end(), [&](const glm::vec3& corner) { return pass(eye, corner); });
  }

 private:
  bool pass(const glm::vec3& from, const glm::vec3& to) const {
    const auto passes = [&](const box& where) {
      float enter = 0.0f, leave = 1.0f;
      return clip_line(where.min, where.max, from, to - from, enter, leave);
    };
    if (!passes(all_)) return false;
    return parts_.size() > most_parts_for_lines ||
           std::any_of(parts_.begin(), parts_.end(),
                       [&](const edited_part& part) { return passes(part.where.grown(near_)); });
  }

  std::span<const edited_part> parts_;
  float near_;  // meters
  box all_;
};

std::vector<std::uint8_t> valid_witnesses(const ray_scene& rays, const found_before& before, const additions& added,
                                          float radius, std::uint64_t& tested) {
  const std::vector<glm::vec3>& eyes = before.record.witnesses;
  std::vector<std::uint8_t> valid(eyes.size(), 1);
  std::vector<glm::vec3> near;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < eyes.size(); ++i)
    if (added.reach(eyes[i])) near.push_back(eyes[i]), which.push_back(i);
  std::vector<std::uint8_t> of_near(near.size());
  rays.find_valid(near, radius, of_near);
  for (std::size_t i = 0; i < near.size(); ++i) valid[which[i]] = of_near[i];
  tested += near.size();
  return valid;
}

std::vector<const triangle*> triangles_of(const found_before& before) {
  std::vector<const triangle*> all;
  for (const auto& parts : {before.removed, before.added})
    for (const edited_part& part : parts)
      for (const triangle& corners : part.corners) all.push_back(&corners);
  return all;
}

// Casts a round of rays from eyes of the set at the edit. Returns the polygons that the set lacks, in an order that
// does not depend on threads.
std::vector<found_polygon> found_at(const std::vector<const triangle*>& edit, const ray_scene& rays,
                                    const neighbor_check_settings& how, std::uint64_t name, const cell_set& set) {
  const std::vector<glm::vec3>& eyes = set.eyes();
  std::vector<std::vector<found_polygon>> found(rays_of_round / task_size);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    aimed_rays aimed(rays, how.rules.smallest_gap, set);
    for (std::size_t i = k * task_size; i < (k + 1) * task_size; ++i) {
      random_stream random(how.seed, how.place, how.use, name, mix_bits(i));
      const triangle& at = *edit[random.bits() % edit.size()];
      const glm::vec3& eye = eyes[random.bits() % eyes.size()];
      (void)aimed.aim(eye, random_point(at, random), no_polygon, found[k]);
    }
  });
  std::vector<found_polygon> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  return all;
}

box box_of(const triangle& t) {
  return {glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
}

}  // namespace

std::uint64_t join_found_before(const ray_scene& rays, const found_before& before, const visibility_rules& rules,
                                cell_set& set) {
  const cell_record& record = before.record;
  const additions added(before.added, rules.player_radius + rules.smallest_gap);
  std::uint64_t tested = 0;
  const std::vector<std::uint8_t> valid = valid_witnesses(rays, before, added, rules.player_radius, tested);
  std::vector<std::uint8_t> keep(record.set.size());
  for (std::size_t i = 0; i < record.set.size(); ++i) {
    const std::uint32_t witness = record.witness_of[i], polygon = record.set[i];
    keep[i] = valid[witness] && !set.contains(polygon) &&
              !added.may_occlude(record.witnesses[witness], corners_of(rays.geometry(), polygon));
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
  const std::vector<const triangle*> edit = triangles_of(before);
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
  // Where the rays of a bound are cast again in vain, new ones have what it left of the confidence. Each such edit
  // halves it.
  constexpr std::uint32_t last_number = 3;
  constexpr std::size_t most_boxes = 256;
  const cell_record& record = before.record;
  if (!record.bound_met || record.of_bound.number == 0 || record.of_bound.number > last_number) return std::nullopt;
  const float near = smallest_gap + 1e-4f;  // lines beside a line (rule 3) are that far away from it
  std::vector<box> changed;
  for (const auto& parts : {before.removed, before.added})
    for (const edited_part& part : parts) changed.push_back(part.where.grown(near));
  for (const std::uint32_t polygon : record.set)
    if (!set.contains(polygon)) changed.push_back(box_of(corners_of(rays.geometry(), polygon)).grown(near));
  if (changed.size() > most_boxes) {
    for (const box& one : changed) changed[0] = {glm::min(changed[0].min, one.min), glm::max(changed[0].max, one.max)};
    changed.resize(1);
  }
  return cast_again{record.of_bound, record.rays, record.misses, record.confidence, std::move(changed)};
}

}  // namespace sightcell::bake
