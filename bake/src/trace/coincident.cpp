#include "trace/coincident.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t polygons_of_task = 1024;

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
           std::vector<polygon_pair>& out) {
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

// Returns the polygons whose probes may meet one that was added: added ones, and those within reach of one.
std::vector<std::uint32_t> near_added(const ray_scene& rays, const std::vector<std::uint32_t>& added, float reach) {
  std::vector<std::vector<std::uint32_t>> found(added.size());
  tbb::parallel_for(std::size_t{0}, added.size(), [&](std::size_t i) {
    const triangle t = corners_of(rays.geometry(), added[i]);
    // Probes begin at a point of a polygon, and rounding moves them by less than their reach.
    const glm::vec3 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
    found[i] = rays.touching(low - 2.0f * reach, high + 2.0f * reach);
  });
  std::vector<std::uint32_t> polygons = added;
  for (const std::vector<std::uint32_t>& some : found) polygons.insert(polygons.end(), some.begin(), some.end());
  std::sort(polygons.begin(), polygons.end());
  polygons.erase(std::unique(polygons.begin(), polygons.end()), polygons.end());
  return polygons;
}

std::vector<std::uint32_t> to_probe(const ray_scene& rays, const partners_before* before, float reach) {
  const std::size_t count = rays.geometry().kinds.size();
  if (before && before->reach == reach && before->added.size() < count / 8)
    return near_added(rays, before->added, reach);
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

}  // namespace

coincident_partners::coincident_partners(const ray_scene& rays, const partners_before* before)
    : reach_(std::clamp(coincidence_reach(glm::distance(rays.geometry().min, rays.geometry().max)), 2e-3f, 1e-2f)) {
  const std::vector<std::uint32_t> probed = to_probe(rays, before, reach_);
  std::vector<std::vector<polygon_pair>> found((probed.size() + polygons_of_task - 1) / polygons_of_task);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t task) {
    std::vector<std::uint32_t> met;
    const std::size_t first = task * polygons_of_task;
    for (const std::uint32_t polygon :
         std::span(probed).subspan(first, std::min(polygons_of_task, probed.size() - first)))
      if (!rays.geometry().kinds[polygon].absent) probe(rays, polygon, reach_, met, found[task]);
  });
  std::vector<polygon_pair> pairs;
  if (before && before->reach == reach_)
    for (const auto& [a, b] : before->pairs) pairs.push_back({a, b}), pairs.push_back({b, a});
  for (std::vector<polygon_pair>& some : found) {
    pairs.insert(pairs.end(), some.begin(), some.end());
    some = {};
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

std::vector<polygon_pair> coincident_partners::pairs() const {
  std::vector<polygon_pair> all;
  for (std::size_t i = 0; i < polygons_.size(); ++i)
    for (std::uint32_t at = starts_[i]; at < starts_[i + 1]; ++at)
      if (polygons_[i] < partners_[at]) all.push_back({polygons_[i], partners_[at]});
  return all;
}

std::span<const std::uint32_t> coincident_partners::of(std::uint32_t polygon) const {
  const auto found = std::lower_bound(polygons_.begin(), polygons_.end(), polygon);
  if (found == polygons_.end() || *found != polygon) return {};
  const auto at = static_cast<std::size_t>(found - polygons_.begin());
  return std::span(partners_).subspan(starts_[at], starts_[at + 1] - starts_[at]);
}

}  // namespace sightcell::bake
