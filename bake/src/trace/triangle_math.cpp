#include "trace/triangle_math.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sightcell::bake {
namespace {

// Returns the nearest point of the triangle, by the Voronoi region (of a corner, an edge or the face) that contains p.
glm::vec3 nearest_on_triangle(const glm::vec3& p, const triangle& t) {
  const glm::vec3 &a = t[0], &b = t[1], &c = t[2];
  const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0f && d2 <= 0.0f) return a;
  const glm::vec3 bp = p - b;
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0f && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) return a + ab * (d1 / (d1 - d3));
  const glm::vec3 cp = p - c;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0f && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) return a + ac * (d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const float denominator = 1.0f / (va + vb + vc);
  return a + ab * (vb * denominator) + ac * (vc * denominator);
}

bool separates(const glm::vec3& axis, const triangle& local, const glm::vec3& half) {
  const float p0 = glm::dot(axis, local[0]), p1 = glm::dot(axis, local[1]), p2 = glm::dot(axis, local[2]);
  const float reach = glm::dot(glm::abs(axis), half);
  return std::min({p0, p1, p2}) > reach || std::max({p0, p1, p2}) < -reach;
}

}  // namespace

float solid_angle(const triangle& corners, const glm::vec3& eye) {
  const glm::vec3 a = corners[0] - eye, b = corners[1] - eye, c = corners[2] - eye;
  const float la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const float volume = std::abs(glm::dot(a, glm::cross(b, c)));
  const float below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la;
  return std::min(2.0f * std::atan2(volume, below), largest_solid_angle);
}

float distance_to_triangle(const glm::vec3& point, const triangle& corners) {
  return glm::distance(point, nearest_on_triangle(point, corners));
}

bool triangle_touches_box(const triangle& corners, const glm::vec3& min, const glm::vec3& max) {
  // The bounding boxes decide nearly all cases.
  const glm::vec3 low = glm::min(glm::min(corners[0], corners[1]), corners[2]);
  const glm::vec3 high = glm::max(glm::max(corners[0], corners[1]), corners[2]);
  for (int k = 0; k < 3; ++k)
    if (low[k] > max[k] || high[k] < min[k]) return false;

  const glm::vec3 center = 0.5f * (min + max), half = 0.5f * (max - min);
  const triangle local{corners[0] - center, corners[1] - center, corners[2] - center};
  const std::array<glm::vec3, 3> edges{local[1] - local[0], local[2] - local[1], local[0] - local[2]};
  if (separates(glm::cross(edges[0], edges[1]), local, half)) return false;
  for (const glm::vec3& edge : edges)
    for (int k = 0; k < 3; ++k) {
      glm::vec3 unit{0.0f};
      unit[k] = 1.0f;
      if (separates(glm::cross(unit, edge), local, half)) return false;
    }
  return true;
}

// The nearest points are found by turns: the one of the triangle to that of the box, and the other way round. The plane
// between them separates triangle and box by a width that is never above the distance.
double least_distance(const triangle& corners, const glm::vec3& min, const glm::vec3& max) {
  constexpr int most_turns = 32;
  double best = 0.0;
  glm::vec3 of_box = glm::clamp((corners[0] + corners[1] + corners[2]) / 3.0f, min, max);
  for (int turn = 0; turn < most_turns; ++turn) {
    const glm::vec3 of_triangle = nearest_on_triangle(of_box, corners);
    const glm::vec3 next = glm::clamp(of_triangle, min, max);
    const glm::dvec3 way = glm::dvec3(of_triangle) - glm::dvec3(next);
    const double length = glm::length(way);
    if (!(length > 0.0)) return best;
    const glm::dvec3 normal = way / length;
    double nearest = glm::dot(normal, glm::dvec3(corners[0]));
    for (const glm::vec3& corner : corners) nearest = std::min(nearest, glm::dot(normal, glm::dvec3(corner)));
    for (int k = 0; k < 3; ++k)
      nearest -= std::max(normal[k] * static_cast<double>(min[k]), normal[k] * static_cast<double>(max[k]));
    best = std::max(best, nearest);
    if (best >= 0.9999 * length || next == of_box) break;
    of_box = next;
  }
  return best;
}

}  // namespace sightcell::bake
