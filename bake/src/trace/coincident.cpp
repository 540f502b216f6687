#include "trace/coincident.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <utility>

#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t chunk_polygons = 4096;

using pair = std::pair<std::uint32_t, std::uint32_t>;

glm::vec3 normal_of(const triangle& t) {
  const glm::dvec3 a(t[0]);
  return glm::vec3(glm::normalize(glm::cross(glm::dvec3(t[1]) - a, glm::dvec3(t[2]) - a)));
}

std::array<glm::vec3, 4> probes_of(const triangle& t) {
  const auto near = [](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return a * 0.8f + b * 0.1f + c * 0.1f;
  };
  return {(t[0] + t[1] + t[2]) / 3.0f, near(t[0], t[1], t[2]), near(t[1], t[2], t[0]), near(t[2], t[0], t[1])};
}

void probe(const ray_scene& rays, std::uint32_t polygon, float reach, std::vector<std::uint32_t>& met,
           std::vector<pair>& out) {
  const triangle corners = corners_of(rays.geometry(), polygon);
  const glm::vec3 normal = normal_of(corners);
  const bool both = rays.sees_both_sides(polygon);
  const std::size_t before = out.size();
  for (const glm::vec3& point : probes_of(corners)) {
    rays.stacked(point, normal, reach, met);
    for (const std::uint32_t other : met) {
      if (other == polygon) continue;
      const bool same_eye =
          both || rays.sees_both_sides(other) || glm::dot(normal, normal_of(corners_of(rays.geometry(), other))) > 0.0f;
      if (!same_eye) continue;
      out.push_back({polygon, other});
      out.push_back({other, polygon});
    }
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(before), out.end());
  out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(before), out.end()), out.end());
}

}  // namespace

coincident_partners::coincident_partners(const ray_scene& rays) {
  const auto& kinds = rays.geometry().kinds;
  const float reach =
      std::clamp(coincidence_reach(glm::distance(rays.geometry().min, rays.geometry().max)), 2e-3f, 1e-2f);
  const auto count = static_cast<std::uint32_t>(kinds.size());
  std::vector<std::vector<pair>> found((count + chunk_polygons - 1) / chunk_polygons);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
    std::vector<std::uint32_t> met;
    const auto first = static_cast<std::uint32_t>(chunk) * chunk_polygons;
    for (std::uint32_t polygon = first; polygon < count && polygon < first + chunk_polygons; ++polygon)
      if (!kinds[polygon].absent) probe(rays, polygon, reach, met, found[chunk]);
  });
  std::vector<pair> pairs;
  for (std::vector<pair>& chunk : found) {
    pairs.insert(pairs.end(), chunk.begin(), chunk.end());
    chunk = {};
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  partners_.reserve(pairs.size());
  for (const auto& [polygon, partner] : pairs) {
    if (polygons_.empty() || polygons_.back() != polygon) {
      polygons_.push_back(polygon);
      starts_.push_back(static_cast<std::uint32_t>(partners_.size()));
    }
    partners_.push_back(partner);
  }
  starts_.push_back(static_cast<std::uint32_t>(partners_.size()));
}

std::span<const std::uint32_t> coincident_partners::of(std::uint32_t polygon) const {
  const auto found = std::lower_bound(polygons_.begin(), polygons_.end(), polygon);
  if (found == polygons_.end() || *found != polygon) return {};
  const auto at = static_cast<std::size_t>(found - polygons_.begin());
  return std::span(partners_).subspan(starts_[at], starts_[at + 1] - starts_[at]);
}

}  // namespace sightcell::bake
