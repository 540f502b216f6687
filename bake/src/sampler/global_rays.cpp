#include "sampler/global_rays.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "search/aim.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t viewpoints = 32;      // per cell
constexpr std::uint64_t free_tries = 4096;  // to find the first viewpoint of a cell; cells without any are not stored
constexpr int tries = 4;                    // to find a polygon that faces a cell
constexpr double last_round_weight = 0.5;   // weight of the last round
// Distance of the closest silhouette ray from the edge, as a share of the polygon's size.
constexpr float past_edge = 1e-3f;

// Returns a nearly normal number of variance 1. Sums and products alone give the same bits on every machine.
float nearly_normal(random_stream& numbers) {
  float sum = -2.0f;
  for (int i = 0; i < 4; ++i) sum += numbers.uniform();
  return sum * 1.7320508f;
}

float longest_edge(const triangle& t) {
  return std::max({glm::length(t[1] - t[0]), glm::length(t[2] - t[1]), glm::length(t[0] - t[2])});
}

// Returns a point near `place`, displaced at right angles to the direction.
glm::vec3 beside(const glm::vec3& place, const glm::vec3& direction, float by, random_stream& numbers) {
  const glm::vec3 up = std::abs(direction.y) < 0.9f ? glm::vec3{0, 1, 0} : glm::vec3{1, 0, 0};
  const glm::vec3 right = glm::normalize(glm::cross(direction, up));
  const float x = by * nearly_normal(numbers), y = by * nearly_normal(numbers);
  return place + right * x + glm::cross(right, direction) * y;
}

glm::vec3 unit(const glm::vec3& way) {
  const float length = glm::length(way);
  return length > 0.0f ? way / length : glm::vec3{0.0f};
}

glm::vec3 normal_of(const triangle& t) {
  return unit(glm::cross(t[1] - t[0], t[2] - t[0]));
}

// Returns the parameter, 0 to 1, at which the segment between two points of the triangle's plane leaves the triangle;
// 1 if it does not.
float leaves(const triangle& t, const glm::vec3& from, const glm::vec3& to) {
  const glm::vec3 normal = normal_of(t);
  float first = 1.0f;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3 inward = glm::cross(normal, t[(i + 1) % 3] - t[i]);
    const float a = glm::dot(from - t[i], inward), b = glm::dot(to - t[i], inward);
    if (b < 0.0f && a > b) first = std::min(first, std::max(a, 0.0f) / (a - b));
  }
  return first;
}

}  // namespace

global_rays::global_rays(const ray_scene& rays, std::span<const box> cells) : rays_(rays), cells_(cells) {
  const scene::world_geometry& geometry = rays.geometry();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> named;
  for (std::uint32_t polygon = 0; polygon < geometry.kinds.size(); ++polygon)
    if (!geometry.kinds[polygon].absent) named.emplace_back(name_of(corners_of(geometry, polygon)), polygon);
  std::sort(named.begin(), named.end());
  polygons_.reserve(named.size());
  for (const auto& [name, polygon] : named) polygons_.push_back(polygon);
  off_surface_ = std::max(2e-4f, 1e-6f * glm::length(geometry.max - geometry.min));
}

bool global_rays::find_viewpoints(float player_radius, std::uint64_t seed, std::span<const std::uint64_t> places) {
  free_.assign(cells_.size(), {});
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t cell) {
    random_stream numbers(seed, places[cell], purpose::agvs_place, ~std::uint64_t{0});
    std::uint64_t tried = 0;
    free_[cell] = draw_viewpoints(rays_, cells_[cell], player_radius, viewpoints, free_tries, numbers, tried);
  });
  with_free_.clear();
  for (std::uint32_t cell = 0; cell < cells_.size(); ++cell)
    if (!free_[cell].empty()) with_free_.push_back(cell);
  return !with_free_.empty();
}

std::uint32_t global_rays::any_cell(random_stream& numbers) const {
  return with_free_[numbers.bits() % with_free_.size()];
}

std::uint32_t global_rays::any_polygon(random_stream& numbers) const {
  return polygons_[numbers.bits() % polygons_.size()];
}

global_ray global_rays::random(random_stream& numbers) const {
  const std::uint32_t cell = any_cell(numbers);
  // Half of the rays start at a random point, because there are more viewpoints than the known ones.
  const bool known = numbers.uniform() < 0.5f;
  const glm::vec3 origin =
      known ? free_[cell][numbers.bits() % free_[cell].size()] : numbers.in_box(cells_[cell].min, cells_[cell].max);
  return {.origin = origin, .direction = numbers.on_sphere(), .origin_is_free = known};
}

global_ray global_rays::object(random_stream& numbers) const {
  const std::uint32_t polygon = any_polygon(numbers);
  const triangle corners = corners_of(rays_.geometry(), polygon);
  const glm::vec3 place = random_point(corners, numbers);
  glm::vec3 direction = numbers.on_sphere();
  if (!rays_.sees_both_sides(polygon) && glm::dot(direction, normal_of(corners)) < 0.0f) direction = -direction;
  return {.origin = place + direction * off_surface_, .direction = direction};
}

global_ray global_rays::two_point(random_stream& numbers) const {
  for (int i = 0; i < tries; ++i) {
    const std::uint32_t polygon = any_polygon(numbers);
    const glm::vec3 place = random_point(corners_of(rays_.geometry(), polygon), numbers);
    const std::uint32_t cell = any_cell(numbers);
    const glm::vec3 eye = free_[cell][numbers.bits() % free_[cell].size()];
    if (!faces(rays_, polygon, eye)) continue;
    const glm::vec3 direction = unit(eye - place);
    return {.origin = place + direction * off_surface_, .direction = direction};
  }
  return {};
}

global_ray global_rays::mutation(const mutation_candidate& from, random_stream& numbers) const {
  const glm::vec3 direction = unit(from.point - from.eye);
  // The displacement has the scale of the polygon down to an eighth of it, because neighbors of a large polygon may
  // be small.
  const float scale = 0.5f * longest_edge(corners_of(rays_.geometry(), from.polygon)) *
                      std::ldexp(1.0f, -static_cast<int>(numbers.bits() % 4));
  const glm::vec3 aim = beside(from.point, direction, scale, numbers);
  const glm::vec3 eye = beside(from.eye, direction, std::min(scale, glm::length(from.point - from.eye)), numbers);
  return {.origin = eye, .direction = unit(aim - eye), .polygon = from.polygon, .point = from.point, .aim = aim};
}

global_ray global_rays::silhouette(const mutation_candidate& from, random_stream& numbers) const {
  const triangle corners = corners_of(rays_.geometry(), from.polygon);
  const std::size_t edge = numbers.bits() % 3;
  const glm::vec3 &a = corners[edge], &b = corners[(edge + 1) % 3], &opposite = corners[(edge + 2) % 3];
  const glm::vec3 on_edge = a + (b - a) * numbers.uniform();
  const glm::vec3 direction = unit(on_edge - from.eye);
  // Away from the third corner, as seen from the eye.
  const glm::vec3 along = unit(b - a);
  glm::vec3 out = on_edge - opposite;
  out -= along * glm::dot(out, along);
  out = unit(out - direction * glm::dot(out, direction));
  const float size = longest_edge(corners);
  const float by = std::max(size * past_edge * std::ldexp(1.0f, static_cast<int>(numbers.bits() % 8)), off_surface_);
  const glm::vec3 aim = on_edge + out * by;
  return {.origin = from.eye,
          .direction = unit(aim - from.eye),
          .origin_is_free = true,
          .polygon = from.polygon,
          .point = from.point,
          .aim = aim};
}

global_ray global_rays::reverse(const blocked_ray& from, random_stream& numbers) const {
  const triangle corners = corners_of(rays_.geometry(), from.occluder);
  const glm::vec3 normal = normal_of(corners), earlier = from.point - from.eye;
  const float slope = glm::dot(earlier, normal);
  if (slope == 0.0f) return {};
  // The point where the earlier ray passed the occluder's plane. The edge is between it and the hit.
  const glm::vec3 passed = from.eye + earlier * (glm::dot(from.hit - from.eye, normal) / slope);
  const glm::vec3 way = passed - from.hit;
  const float length = glm::length(way), edge = leaves(corners, from.hit, passed);
  if (!(length > 0.0f) || edge >= 1.0f) return {};
  const float by = longest_edge(corners) * past_edge * std::ldexp(1.0f, static_cast<int>(numbers.bits() % 8));
  const glm::vec3 origin = from.hit + way * edge + way / length * std::max(by, off_surface_);
  return {.origin = origin, .direction = unit(origin - from.aim)};
}

std::array<std::uint64_t, ray_kinds> adaptive_shares::rays_of_round(
    std::uint64_t rays, const std::array<std::uint64_t, ray_kinds>& limits) const {
  double all = 0.0;
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) all += limits[kind] > 0 ? per_ray_[kind] : 0.0;
  std::array<std::uint64_t, ray_kinds> counts{};
  std::uint64_t given = 0;
  for (std::size_t kind = 1; kind < ray_kinds; ++kind) {
    const double share = least + (1.0 - least * ray_kinds) * (all > 0.0 ? per_ray_[kind] / all : 0.0);
    counts[kind] = std::min(static_cast<std::uint64_t>(share * static_cast<double>(rays)), limits[kind]);
    given += counts[kind];
  }
  counts[0] = rays - given;
  return counts;
}

void adaptive_shares::found(ray_kind kind, std::uint64_t rays, std::uint64_t pairs) {
  if (rays == 0) return;
  double& mean = per_ray_[static_cast<std::size_t>(kind)];
  mean += last_round_weight * (static_cast<double>(pairs) / static_cast<double>(rays) - mean);
}

}  // namespace sightcell::bake
