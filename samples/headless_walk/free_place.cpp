#include "free_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace headless_walk {
namespace {

using sightcell::scene::world_geometry;

// What a ray meets first.
struct first_hit {
  float distance = std::numeric_limits<float>::infinity();
  bool back = false;  // of an opaque single-sided polygon
};

// The line through p along an axis against one polygon: fills hits[0] toward the positive and hits[1] toward the
// negative side.
void cross_line(const world_geometry& world, std::size_t polygon, const glm::vec3& p, int axis, first_hit* hits) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::array<glm::vec3, 3> c;
  for (std::size_t k = 0; k < 3; ++k) c[k] = world.positions[world.indices[3 * polygon + k]] - p;
  if (std::min({c[0][u], c[1][u], c[2][u]}) > 0.0f || std::max({c[0][u], c[1][u], c[2][u]}) < 0.0f) return;
  if (std::min({c[0][v], c[1][v], c[2][v]}) > 0.0f || std::max({c[0][v], c[1][v], c[2][v]}) < 0.0f) return;

  // Signed areas seen along the axis; all of one sign: the line passes inside.
  std::array<float, 3> area{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 &a = c[(k + 1) % 3], &b = c[(k + 2) % 3];
    area[k] = a[u] * b[v] - a[v] * b[u];
  }
  const float sum = area[0] + area[1] + area[2];
  const bool inside = (area[0] >= 0 && area[1] >= 0 && area[2] >= 0) || (area[0] <= 0 && area[1] <= 0 && area[2] <= 0);
  if (!inside || sum == 0.0f) return;

  const float along = (area[0] * c[0][axis] + area[1] * c[1][axis] + area[2] * c[2][axis]) / sum;
  first_hit& hit = hits[along >= 0.0f ? 0 : 1];
  if (std::abs(along) >= hit.distance) return;
  const auto kind = world.kinds[polygon];
  // A counter-clockwise polygon has a positive area when it faces the positive side.
  const bool away = (sum > 0.0f) == (along >= 0.0f);
  hit = {std::abs(along), away && !kind.double_sided && kind.alpha == sightcell::scene::alpha_mode::opaque};
}

bool is_free(const world_geometry& world, const glm::vec3& p, float clearance) {
  std::array<std::array<first_hit, 2>, 3> hits;
  for (std::size_t polygon = 0; polygon < world.kinds.size(); ++polygon) {
    if (world.kinds[polygon].absent) continue;
    for (int axis = 0; axis < 3; ++axis)
      cross_line(world, polygon, p, axis, hits[static_cast<std::size_t>(axis)].data());
  }
  for (const auto& line : hits) {
    for (const first_hit& hit : line) {
      if (hit.back || hit.distance < clearance) return false;
    }
  }
  return true;
}

// Halton's sequence: spreads the tries evenly.
float radical_inverse(unsigned i, unsigned base) {
  float result = 0.0f, digit = 1.0f / static_cast<float>(base);
  for (; i > 0; i /= base, digit /= static_cast<float>(base)) result += digit * static_cast<float>(i % base);
  return result;
}

}  // namespace

std::optional<glm::vec3> find_free_place(const world_geometry& world, const box& where, float clearance) {
  const glm::vec3 size = where.max - where.min;
  for (unsigned i = 0; i < 64; ++i) {
    glm::vec3 part(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5));
    if (i == 0) part = glm::vec3(0.5f);
    const glm::vec3 p = where.min + part * size;
    if (is_free(world, p, clearance)) return p;
  }
  return std::nullopt;
}

}  // namespace headless_walk
