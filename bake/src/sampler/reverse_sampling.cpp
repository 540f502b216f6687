#include "sampler/reverse_sampling.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "sampler/border_sampling.h"
#include "trace/line_box.h"

namespace sightcell::bake {
namespace {

// Returns the first point in the cell on the line from border past edge.
std::optional<glm::vec3> eye_past(const glm::vec3& edge, const glm::vec3& border, const box& cell) {
  const glm::vec3 way = edge - border;
  float enter = 1.0f, leave = std::numeric_limits<float>::infinity();  // 1: at the edge
  if (!clip_line(cell.min, cell.max, border, way, enter, leave)) return {};
  const float at = enter > 1.0f ? enter : 0.5f * (enter + leave);
  return glm::clamp(border + way * at, cell.min, cell.max);
}

}  // namespace

bool is_blocked_before(float distance, float reach) {
  return distance < reach - std::max(0.02f, 0.01f * reach);  // the same threshold as in rule 3
}

void add_reverse_eyes(const triangle& occluder, const glm::vec3& eye, const glm::vec3& seen, const glm::vec3& border,
                      float offset, const box& cell, std::vector<glm::vec3>& eyes) {
  const glm::vec3 normal = glm::cross(seen - eye, border - eye);
  const glm::vec3 across = glm::cross(border - eye, normal);  // in the plane, at right angles to the blocked ray
  if (!(glm::dot(across, across) > 0.0f)) return;
  const border_polygon ring = enlarged(occluder, eye, offset);
  std::optional<glm::vec3> low, high;
  float lowest = 0.0f, highest = 0.0f;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::vec3 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const float above = glm::dot(normal, a - eye), below = glm::dot(normal, b - eye);
    if ((above > 0.0f) == (below > 0.0f)) continue;
    const glm::vec3 cut = a + (b - a) * (above / (above - below));
    const float at = glm::dot(across, cut - eye);
    if (!low || at < lowest) low = cut, lowest = at;
    if (!high || at > highest) high = cut, highest = at;
  }
  for (const auto& end : {low, high})
    if (end)
      if (const auto start = eye_past(*end, border, cell)) eyes.push_back(*start);
}

}  // namespace sightcell::bake
