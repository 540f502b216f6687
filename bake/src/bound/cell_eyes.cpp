#include "bound/cell_eyes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>

#include "sightcell/format/eye_table.h"

namespace sightcell::bake {
namespace {

constexpr float side_per_eye = 8.0f;  // meters
constexpr std::size_t most_eyes = 4;
constexpr std::size_t most_tests = 16;  // of candidates for one eye

struct candidate {
  format::eye_steps steps;
  glm::vec3 at;
  float rank = 0.0f;  // the least is tested first
};

std::vector<candidate> candidates_of(const box& own, const viewpoint_region& region, std::span<const glm::vec3> known) {
  const format::box cell{{own.min.x, own.min.y, own.min.z}, {own.max.x, own.max.y, own.max.z}};
  std::vector<candidate> found;
  for (const glm::vec3& p : known) {
    if (glm::any(glm::lessThan(p, own.min)) || glm::any(glm::greaterThanEqual(p, own.max))) continue;
    const format::eye_steps steps = format::eye_at(cell, {p.x, p.y, p.z});
    const std::array<float, 3> at = format::eye_position(cell, steps);
    const glm::vec3 position{at[0], at[1], at[2]};
    if (region.contains(position)) found.push_back({steps, position});
  }
  return found;
}

glm::vec3 middle_of(std::span<const candidate> all) {
  glm::dvec3 sum{0.0};
  for (const candidate& c : all) sum += glm::dvec3(c.at);
  return glm::vec3(sum / static_cast<double>(all.size()));
}

}  // namespace

std::vector<format::eye_steps> choose_eyes(const ray_scene& rays, const box& own, const viewpoint_region& region,
                                           float radius, std::span<const glm::vec3> known) {
  std::vector<candidate> all = candidates_of(own, region, known);
  if (all.empty()) return {};
  const glm::vec3 middle = middle_of(all);
  for (candidate& c : all) c.rank = glm::distance(c.at, middle);
  const glm::vec3 size = own.max - own.min;
  const float eyes_by_size = std::ceil(std::max({size.x, size.y, size.z}) / side_per_eye);
  const auto wanted = static_cast<std::size_t>(std::clamp(eyes_by_size, 1.0f, static_cast<float>(most_eyes)));
  std::vector<format::eye_steps> eyes;
  std::vector<glm::vec3> chosen;
  while (eyes.size() < wanted) {
    std::stable_sort(all.begin(), all.end(), [](const candidate& a, const candidate& b) { return a.rank < b.rank; });
    const auto tested = all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), most_tests));
    const auto next =
        std::find_if(all.begin(), tested, [&](const candidate& c) { return rays.is_valid(c.at, radius); });
    if (next == tested) break;
    eyes.push_back(next->steps);
    chosen.push_back(next->at);
    all.erase(next);
    for (candidate& c : all) {
      float nearest = std::numeric_limits<float>::infinity();
      for (const glm::vec3& eye : chosen) nearest = std::min(nearest, glm::distance(c.at, eye));
      c.rank = -nearest;
    }
  }
  return eyes;
}

}  // namespace sightcell::bake
