#include "clearance.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace gpu_driven {
namespace {

constexpr std::uint32_t block_polygons = 64;

float squared(const glm::vec3& v) {
  return glm::dot(v, v);
}

float squared_distance_to_edge(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 along = b - a;
  const float length = squared(along);
  const float t = length > 0.0f ? std::clamp(glm::dot(p - a, along) / length, 0.0f, 1.0f) : 0.0f;
  return squared(p - (a + t * along));
}

float squared_distance_to_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 normal = glm::cross(b - a, c - a);
  const float area = squared(normal);
  const auto is_inside = [&](const glm::vec3& from, const glm::vec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0.0f;
  };
  if (area > 0.0f && is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
    const float away = glm::dot(p - a, normal);
    return away * away / area;
  }
  return std::min(
      {squared_distance_to_edge(p, a, b), squared_distance_to_edge(p, b, c), squared_distance_to_edge(p, c, a)});
}

}  // namespace

clearance::clearance(const sightcell::scene::world_geometry& world, float radius)
    : world_(world), radius_(std::max(radius, 0.01f)) {
  const auto polygons = static_cast<std::uint32_t>(world.kinds.size());
  for (std::uint32_t first = 0; first < polygons; first += block_polygons) {
    block made{glm::vec3(1e30f), glm::vec3(-1e30f), first, std::min(block_polygons, polygons - first)};
    for (std::uint32_t p = first; p < first + made.count; ++p) {
      if (world.kinds[p].absent) continue;
      for (std::size_t corner = 3 * std::size_t{p}; corner < 3 * std::size_t{p} + 3; ++corner) {
        made.min = glm::min(made.min, world.positions[world.indices[corner]]);
        made.max = glm::max(made.max, world.positions[world.indices[corner]]);
      }
    }
    if (made.min.x <= made.max.x) blocks_.push_back(made);
  }
}

bool clearance::is_clear_at(const glm::vec3& at, const std::vector<std::uint32_t>& near_blocks) const {
  const float limit = radius_ * radius_;
  for (const std::uint32_t b : near_blocks) {
    const block& own = blocks_[b];
    if (squared(glm::max(glm::max(own.min - at, at - own.max), glm::vec3(0.0f))) >= limit) continue;
    for (std::uint32_t p = own.first; p < own.first + own.count; ++p) {
      if (world_.kinds[p].absent) continue;
      const auto corner = [&](std::size_t k) { return world_.positions[world_.indices[3 * std::size_t{p} + k]]; };
      if (squared_distance_to_triangle(at, corner(0), corner(1), corner(2)) < limit) return false;
    }
  }
  return true;
}

bool clearance::is_clear(const glm::vec3& from, const glm::vec3& to) const {
  const glm::vec3 low = glm::min(from, to) - radius_, high = glm::max(from, to) + radius_;
  std::vector<std::uint32_t> near_blocks;
  for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
    const block& own = blocks_[b];
    if (glm::all(glm::lessThanEqual(own.min, high)) && glm::all(glm::greaterThanEqual(own.max, low)))
      near_blocks.push_back(b);
  }
  // Steps as long as the radius: no surface fits between two points that keep the radius from it.
  const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(to - from) / radius_)));
  for (int i = 0; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    if (!is_clear_at(from + t * (to - from), near_blocks)) return false;
  }
  return true;
}

}  // namespace gpu_driven
