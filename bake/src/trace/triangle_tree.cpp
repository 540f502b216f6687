#include "trace/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "trace/line_box.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t triangles_of_leaf = 4;
constexpr std::size_t most_levels = 64;  // medians halve, so 2^32 triangles have fewer

box box_of(const triangle& t) {
  return {glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
}

constexpr float rounding = 1e-6f;  // of coordinates and of what is computed from them, as a share

float largest_of(const glm::vec3& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

bool passes_box(const box& around, const glm::vec3& start, const glm::vec3& direction, float length) {
  float enter = 0.0f, leave = length;
  return clip_line(around.min, around.max, start, direction, enter, leave);
}

// Clips a line to the prism over the triangle whose sides are moved outward by near. It contains all points that are as
// close to the triangle, and more at acute corners. Of slivers the normal is rounding noise, so their box counts.
bool passes_prism(const triangle& t, float near, const glm::dvec3& start, const glm::dvec3& direction, float length) {
  const std::array<glm::dvec3, 3> corners{t[0], t[1], t[2]};
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double twice_area = glm::length(normal);
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::length(corners[(k + 1) % 3] - corners[k]));
  constexpr double thinnest = 1e-7;
  if (!(twice_area > thinnest * longest * longest)) return passes_box(box_of(t).grown(near), start, direction, length);
  double from = 0.0, to = length;
  // Keeps the part of the line behind the plane through a point that is moved by near along its normal, a unit vector.
  const auto clip = [&](const glm::dvec3& plane, const glm::dvec3& point) {
    const double along = glm::dot(plane, direction), left = glm::dot(plane, point - start) + near;
    if (along > 0.0)
      to = std::min(to, left / along);
    else if (along < 0.0)
      from = std::max(from, left / along);
    else if (left < 0.0)
      return false;
    return from <= to;
  };
  const glm::dvec3 up = normal / twice_area;
  if (!clip(up, corners[0]) || !clip(-up, corners[0])) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 outward = glm::cross(corners[(k + 1) % 3] - corners[k], up);
    if (!clip(outward / glm::length(outward), corners[k])) return false;
  }
  return true;
}

}  // namespace

triangle_tree::triangle_tree(std::vector<triangle> triangles, float near)
    : triangles_(std::move(triangles)), near_(near) {
  float largest = 0.0f;
  for (const triangle& t : triangles_)
    for (const glm::vec3& corner : t) largest = std::max(largest, largest_of(corner));
  near_ += rounding * largest;
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()));
}

void triangle_tree::build(std::uint32_t first, std::uint32_t count) {
  const auto begin = triangles_.begin() + first, end = begin + count;
  box around = box_of(*begin);
  for (auto t = begin; t != end; ++t) {
    const box one = box_of(*t);
    around = {glm::min(around.min, one.min), glm::max(around.max, one.max)};
  }
  const std::size_t place = nodes_.size();
  nodes_.push_back({around.grown(near_), first, count});
  if (count <= triangles_of_leaf) return;
  const glm::vec3 size = around.max - around.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto center = [axis](const triangle& t) { return t[0][axis] + t[1][axis] + t[2][axis]; };
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, end,
                   [&](const triangle& a, const triangle& b) { return center(a) < center(b); });
  build(first, half);
  nodes_[place].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[place].count = 0;
  build(first + half, count - half);
}

bool triangle_tree::passes(const glm::vec3& start, const glm::vec3& direction, float length) const {
  if (nodes_.empty()) return false;
  const float more = rounding * largest_of(start);
  std::array<std::uint32_t, most_levels> open;
  std::size_t waiting = 0;
  open[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t place = open[--waiting];
    const node& at = nodes_[place];
    if (!passes_box(at.around.grown(more), start, direction, length)) continue;
    for (std::uint32_t i = at.first; i < at.first + at.count; ++i)
      if (passes_prism(triangles_[i], near_ + more, start, direction, length)) return true;
    if (at.count == 0) {
      open[waiting++] = at.first;
      open[waiting++] = place + 1;
    }
  }
  return false;
}

}  // namespace sightcell::bake
