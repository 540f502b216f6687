#include "triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace viewer {
namespace {

constexpr std::uint32_t most_in_leaf = 4;
constexpr std::size_t deepest = 64;  // halves of 2^32 triangles

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The distance at which a ray enters a box, or infinity.
float entry(const glm::vec3& min, const glm::vec3& max, const glm::vec3& from, const glm::vec3& inverse, float reach) {
  const glm::vec3 a = (min - from) * inverse, b = (max - from) * inverse;
  float low = 0.0f, high = reach;
  for (int k = 0; k < 3; ++k) {
    // A ray in the plane of a side gives no number; it then leaves the interval as it is.
    low = std::max(low, std::min(a[k], b[k]));
    high = std::min(high, std::max(a[k], b[k]));
  }
  return low <= high ? low : std::numeric_limits<float>::infinity();
}

// Moeller and Trumbore.
std::optional<float> hit(const std::array<glm::vec3, 3>& t, const glm::vec3& from, const glm::vec3& direction) {
  const glm::vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  const glm::vec3 p = glm::cross(direction, ac);
  const float determinant = glm::dot(ab, p);
  if (std::abs(determinant) < 1e-12f) return std::nullopt;
  const glm::vec3 s = (from - t[0]) / determinant;
  const float u = glm::dot(s, p);
  const glm::vec3 q = glm::cross(s, ab);
  const float v = glm::dot(direction, q);
  const float distance = glm::dot(ac, q);
  if (u < 0.0f || v < 0.0f || u + v > 1.0f || distance < 0.0f) return std::nullopt;
  return distance;
}

// Ericson, Real-Time Collision Detection, 5.1.5.
glm::vec3 nearest_of(const std::array<glm::vec3, 3>& t, const glm::vec3& p) {
  const glm::vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  const glm::vec3 ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0f && d2 <= 0.0f) return t[0];
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0f && d4 <= d3) return t[1];
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) return t[0] + d1 / (d1 - d3) * ab;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0f && d5 <= d6) return t[2];
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) return t[0] + d2 / (d2 - d6) * ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) {
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  }
  return t[0] + (vb * ab + vc * ac) / (va + vb + vc);
}

}  // namespace

triangle_tree::triangle_tree(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
    : positions_(positions), indices_(indices) {
  const auto count = static_cast<std::uint32_t>(indices.size() / 3);
  std::vector<glm::vec3> centers(count);
  order_.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const glm::vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const glm::vec3 area = glm::cross(b - a, c - a);
    if (!is_finite(a) || !is_finite(b) || !is_finite(c) || !(glm::dot(area, area) > 0.0f)) continue;
    centers[t] = (a + b + c) / 3.0f;
    order_.push_back(t);
  }
  if (order_.empty()) return;
  nodes_.reserve(order_.size());
  build(0, static_cast<std::uint32_t>(order_.size()), centers);
}

void triangle_tree::build(std::uint32_t begin, std::uint32_t end, std::span<const glm::vec3> centers) {
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  glm::vec3 min(std::numeric_limits<float>::max()), max = -min, low = min, high = max;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      min = glm::min(min, corner(order_[i], k));
      max = glm::max(max, corner(order_[i], k));
    }
    low = glm::min(low, centers[order_[i]]);
    high = glm::max(high, centers[order_[i]]);
  }
  nodes_[at].min = min;
  nodes_[at].max = max;
  if (end - begin <= most_in_leaf) {
    nodes_[at].first = begin;
    nodes_[at].count = end - begin;
    return;
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return centers[a][axis] < centers[b][axis]; });
  build(begin, middle, centers);
  nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, centers);
}

std::optional<float> triangle_tree::cast(const glm::vec3& from, const glm::vec3& direction, float reach) const {
  if (nodes_.empty()) return std::nullopt;
  const glm::vec3 inverse = 1.0f / direction;
  std::optional<float> found;
  std::array<std::uint32_t, deepest> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const node& n = nodes_[number];
    if (!(entry(n.min, n.max, from, inverse, reach) <= reach)) continue;
    for (std::uint32_t i = 0; i < n.count; ++i) {
      const std::uint32_t t = order_[n.first + i];
      const auto distance = hit({corner(t, 0), corner(t, 1), corner(t, 2)}, from, direction);
      if (distance && *distance <= reach) found = reach = *distance;
    }
    if (n.count > 0) continue;
    const std::uint32_t left = number + 1, right = n.first;
    const bool left_first = entry(nodes_[left].min, nodes_[left].max, from, inverse, reach) <=
                            entry(nodes_[right].min, nodes_[right].max, from, inverse, reach);
    waiting[count++] = left_first ? right : left;
    waiting[count++] = left_first ? left : right;
  }
  return found;
}

std::optional<glm::vec3> triangle_tree::nearest(const glm::vec3& center, float radius) const {
  if (nodes_.empty()) return std::nullopt;
  std::optional<glm::vec3> found;
  std::array<std::uint32_t, deepest> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const node& n = nodes_[number];
    if (glm::distance(glm::clamp(center, n.min, n.max), center) >= radius) continue;
    for (std::uint32_t i = 0; i < n.count; ++i) {
      const std::uint32_t t = order_[n.first + i];
      const glm::vec3 p = nearest_of({corner(t, 0), corner(t, 1), corner(t, 2)}, center);
      const float distance = glm::distance(p, center);
      if (distance >= radius) continue;
      found = p;
      radius = distance;
    }
    if (n.count > 0) continue;
    waiting[count++] = n.first;
    waiting[count++] = number + 1;
  }
  return found;
}

}  // namespace viewer
