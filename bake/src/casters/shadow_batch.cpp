#include "casters/shadow_batch.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "bound/bound_rays.h"
#include "bound/valid_count.h"
#include "trace/direction_code.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// Small enough that the parts of a batch keep all threads busy, and large enough for packets of similar rays.
constexpr std::uint64_t rays_of_part = 16384;
constexpr std::uint64_t fewest_tests_of_batch = 256, rays_per_tested_eye = 256;
constexpr std::uint64_t most_tests_per_valid_eye = 256;

// A shadow map cannot tell a caster from a receiver that is nearer than this.
constexpr float least_bias = 2e-3f;  // meters

struct sun_line {
  sight_line line;
  glm::vec3 to_light{0.0f};
};

// Sorted so that lines with similar directions share packets.
void sort_for_packets(std::vector<sun_line>& lines, const box& around) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order(lines.size());
  for (std::uint32_t i = 0; i < order.size(); ++i)
    order[i] = {direction_code(lines[i].line.direction) << 15 |
                    place_code(lines[i].line.eye, around.min, around.max - around.min),
                i};
  std::sort(order.begin(), order.end());
  std::vector<sun_line> sorted;
  sorted.reserve(lines.size());
  for (const auto& [code, i] : order) sorted.push_back(lines[i]);
  lines = std::move(sorted);
}

}  // namespace

struct shadow_batch::part {
  std::uint64_t cast = 0, tested = 0, valid = 0, misses = 0, viewpoints_tested = 0;
  std::vector<missed_shadow> missed;
};

shadow_line shadow_line_of(const glm::vec3& point, float distance, const glm::vec3& to_light, std::uint32_t receiver) {
  return {point, to_light, std::max(least_bias, 2.0f * coincidence_reach(distance)), receiver};
}

bool faces_light(const scene::world_geometry& geometry, std::uint32_t polygon, const glm::vec3& seen_along,
                 const glm::vec3& to_light) {
  const triangle t = corners_of(geometry, polygon);
  const glm::vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const float toward_light = glm::dot(normal, to_light);
  return glm::dot(normal, seen_along) < 0.0f ? toward_light > 0.0f : toward_light < 0.0f;
}

bool lacks_shadow(const ray_scene& rays, const sight_line& line, const sight& seen, const glm::vec3& to_light,
                  const caster_sets& sets, std::vector<missed_shadow>& missed) {
  thread_local lacking_casters lacking;
  bool any = false;
  const auto test = [&](std::uint32_t polygon, float distance) {
    if (!sets.camera(polygon) || !faces_light(rays.geometry(), polygon, line.direction, to_light)) return;
    const glm::vec3 point = line.eye + line.direction * distance;
    if (!find_lacking(rays, shadow_line_of(point, distance, to_light, polygon), sets.drawn, lacking)) return;
    missed.push_back({line.eye, point, to_light, polygon, lacking});
    any = true;
  };
  if (seen.front != no_polygon) test(seen.front, seen.distance);
  for (const passed_polygon& p : seen.before) test(p.polygon, p.distance);
  return any;
}

shadow_batch::part shadow_batch::cast_part(std::uint64_t count, std::uint64_t tests, random_stream random) const {
  part result;
  std::vector<sun_line> lines(count);
  for (sun_line& one : lines) {
    one.line.eye = where_.draw(random);
    one.line.direction = random.on_sphere();
    one.to_light = sun_.draw(random);
  }
  // The first ones are tested, before the lines are sorted by what decides a miss.
  std::vector<glm::vec3> eyes;
  for (std::size_t i = 0; i < std::min<std::size_t>(tests, lines.size()); ++i) eyes.push_back(lines[i].line.eye);
  sort_for_packets(lines, where_.whole());
  std::vector<sight_line> sorted;
  for (const sun_line& one : lines) sorted.push_back(one.line);
  std::vector<sight> seen(lines.size());
  rays_.trace(sorted, seen);
  std::vector<missed_shadow> found;
  std::vector<std::size_t> ends;  // in `found`, of each suspect line
  const std::size_t tested = eyes.size();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lacks_shadow(rays_, sorted[i], seen[i], lines[i].to_light, sets_, found)) continue;
    eyes.push_back(sorted[i].eye);
    ends.push_back(found.size());
  }
  std::vector<std::uint8_t> valid(eyes.size());
  rays_.find_valid(eyes, player_radius_, valid);
  result.cast = count;
  result.tested = tested;
  result.viewpoints_tested = eyes.size();
  result.valid = static_cast<std::uint64_t>(
      std::count(valid.begin(), valid.begin() + static_cast<std::ptrdiff_t>(tested), std::uint8_t{1}));
  for (std::size_t k = 0, from = 0; k < ends.size(); from = ends[k++]) {
    if (!valid[tested + k]) continue;  // an invalid viewpoint is no trial
    ++result.misses;
    std::move(found.begin() + static_cast<std::ptrdiff_t>(from), found.begin() + static_cast<std::ptrdiff_t>(ends[k]),
              std::back_inserter(result.missed));
  }
  return result;
}

// For regions with hardly any valid viewpoint: every viewpoint is tested, so every ray is a trial.
shadow_batch::part shadow_batch::cast_tested_part(std::uint64_t count, random_stream random) const {
  part result;
  const auto eyes = draw_viewpoints(rays_, where_, player_radius_, count, count * most_tests_per_valid_eye, random,
                                    result.viewpoints_tested);
  sight seen;
  for (const glm::vec3& eye : eyes) {
    const sight_line line{eye, random.on_sphere()};
    const glm::vec3 to_light = sun_.draw(random);
    rays_.trace(line.eye, line.direction, seen);
    if (lacks_shadow(rays_, line, seen, to_light, sets_, result.missed)) ++result.misses;
  }
  result.cast = result.tested = result.valid = eyes.size();
  return result;
}

void shadow_batch::cast(std::uint64_t trials) {
  const bool all_tested = valid_share_ < fewest_valid;
  const auto count =
      static_cast<std::uint64_t>(std::ceil(static_cast<double>(trials) / (all_tested ? 1.0 : valid_share_)));
  std::vector<part> parts((count + rays_of_part - 1) / rays_of_part);
  const std::uint64_t tests = std::max(fewest_tests_of_batch, count / rays_per_tested_eye);
  const std::uint64_t tests_of_part = (tests + parts.size() - 1) / std::max<std::size_t>(parts.size(), 1);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    const std::uint64_t size = std::min(rays_of_part, count - i * rays_of_part);
    const random_stream random(source_.seed, source_.place, source_.use, source_.round, parts_ + i);
    parts[i] = all_tested ? cast_tested_part(size, random) : cast_part(size, tests_of_part, random);
  });
  parts_ += parts.size();
  for (part& one : parts) {
    cast_ += one.cast, tested_ += one.tested, valid_ += one.valid;
    misses_ += one.misses, viewpoints_tested_ += one.viewpoints_tested;
    std::move(one.missed.begin(), one.missed.end(), std::back_inserter(missed_));
  }
}

// Every miss is a trial, too.
std::uint64_t shadow_batch::trials(double risk) const {
  return std::max(valid_at_least(cast_, tested_, valid_, risk), misses_);
}

}  // namespace sightcell::bake
