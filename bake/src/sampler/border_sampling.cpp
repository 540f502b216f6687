#include "sampler/border_sampling.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <tuple>

namespace sightcell::bake {
namespace {

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : otherwise;
}

// Returns the direction at right angles to the plane through the eye and the edge, away from the third corner.
glm::vec3 outward(const glm::vec3& from, const glm::vec3& to, const glm::vec3& third, const glm::vec3& eye) {
  const glm::vec3 edge = to - from;
  // If the eye is in line with the edge there is no such plane, and the direction away from the third corner is used.
  const glm::vec3 away = unit_or(from - third, {0.0f, 1.0f, 0.0f});
  const glm::vec3 side = unit_or(glm::cross(edge, from - eye), away);
  return glm::dot(side, third - from) > 0.0f ? -side : side;
}

void bisect(const border_hit& a, const border_hit& b, std::uint32_t depth, const border_cast& cast) {
  if (depth == 0 || a.front == b.front) return;
  const border_hit middle = cast(0.5f * (a.point + b.point));
  bisect(a, middle, depth - 1, cast);
  bisect(middle, b, depth - 1, cast);
}

}  // namespace

border_polygon enlarged(const triangle& corners, const glm::vec3& eye, float offset) {
  const auto below = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  const auto first =
      static_cast<std::size_t>(std::min_element(corners.begin(), corners.end(), below) - corners.begin());
  triangle t;
  for (std::size_t i = 0; i < 3; ++i) t[i] = corners[(first + i) % 3];
  std::array<glm::vec3, 3> sides;  // per corner: direction for the edge that begins there
  for (std::size_t i = 0; i < 3; ++i) sides[i] = outward(t[i], t[(i + 1) % 3], t[(i + 2) % 3], eye);
  border_polygon border;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3 &ending = sides[(i + 2) % 3], &beginning = sides[i];
    const glm::vec3 bisector = unit_or(ending + beginning, beginning);
    const float by = offset * glm::length(t[i] - eye);
    border[3 * i] = t[i] + ending * by;
    border[3 * i + 1] = t[i] + bisector * by;
    border[3 * i + 2] = t[i] + beginning * by;
  }
  return border;
}

void sample_border(const border_polygon& border, std::uint32_t depth, const border_cast& cast) {
  std::array<border_hit, 9> hits;
  std::transform(border.begin(), border.end(), hits.begin(), cast);
  for (std::size_t i = 0; i < hits.size(); ++i) bisect(hits[i], hits[(i + 1) % hits.size()], depth, cast);
}

std::uint64_t most_border_rays(std::uint32_t depth) {
  return std::uint64_t{9} << depth;
}

}  // namespace sightcell::bake
