#include "surface_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace sightcell::scene {
namespace {

// Texture coordinates that differ by less, of their size, differ by rounding.
constexpr double rounding_of_uvs = 1e-6;
// The least part of the area of a triangle that is as long and as wide as its texture coordinates, for its scale to be
// known in all directions.
constexpr double least_uv_area = 1e-6;

double squared(const glm::dvec3& v) {
  return glm::dot(v, v);
}

using weights = std::array<double, 3>;  // of the corners

struct measured_triangle {
  std::array<glm::dvec3, 3> corners;
  std::array<glm::dvec2, 3> uvs;
  glm::dvec3 center{0.0};
  double radius = 0.0;

  explicit measured_triangle(const surface_triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) corners[k] = glm::dvec3(t.corners[k]), uvs[k] = glm::dvec2(t.uvs[k]);
    center = (corners[0] + corners[1] + corners[2]) / 3.0;
    for (const glm::dvec3& corner : corners) radius = std::max(radius, std::sqrt(squared(corner - center)));
  }

  glm::dvec3 place(const weights& w) const { return w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]; }
  glm::dvec2 uv(const weights& w) const { return w[0] * uvs[0] + w[1] * uvs[1] + w[2] * uvs[2]; }
};

// The nearest point of a triangle, which may have no area.
weights nearest_of(const measured_triangle& t, const glm::dvec3& p) {
  const std::array<glm::dvec3, 3>& c = t.corners;
  const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
  const double area = squared(normal);
  weights inside;
  for (std::size_t k = 0; k < 3; ++k)
    inside[k] = glm::dot(glm::cross(c[(k + 2) % 3] - c[(k + 1) % 3], p - c[(k + 1) % 3]), normal);
  if (area > 0.0 && inside[0] >= 0.0 && inside[1] >= 0.0 && inside[2] >= 0.0) {
    const double sum = inside[0] + inside[1] + inside[2];
    return {inside[0] / sum, inside[1] / sum, inside[2] / sum};
  }
  weights best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 along = c[(k + 1) % 3] - c[k];
    const double length = squared(along);
    const double at = length > 0.0 ? std::clamp(glm::dot(p - c[k], along) / length, 0.0, 1.0) : 0.0;
    const double distance = squared(p - (c[k] + at * along));
    if (distance >= least) continue;
    least = distance;
    best = {};
    best[k] = 1.0 - at;
    best[(k + 1) % 3] = at;
  }
  return best;
}

// How far it is on the plane of a triangle to the point whose texture coordinates are greater by `step`.
double way_along(const measured_triangle& t, const glm::dvec2& step) {
  if (step == glm::dvec2(0.0)) return 0.0;
  const glm::dvec2 across = t.uvs[1] - t.uvs[0], down = t.uvs[2] - t.uvs[0];
  const double area = across.x * down.y - across.y * down.x;
  const double longest =
      std::max({glm::dot(across, across), glm::dot(down, down), glm::dot(down - across, down - across)});
  if (std::abs(area) > least_uv_area * longest) {
    const double a = (step.x * down.y - step.y * down.x) / area, b = (across.x * step.y - across.y * step.x) / area;
    return std::sqrt(squared(a * (t.corners[1] - t.corners[0]) + b * (t.corners[2] - t.corners[0])));
  }
  const double size = std::max({1.0, std::abs(t.uvs[0].x), std::abs(t.uvs[0].y)});
  const double length = glm::length(step);
  if (length <= rounding_of_uvs * size) return 0.0;
  if (!(longest > 0.0)) return std::numeric_limits<double>::infinity();
  return length / std::sqrt(longest) * 2.0 * t.radius;  // they run along one line
}

class measured_surface {
 public:
  explicit measured_surface(std::span<const surface_triangle> triangles) : all_(triangles.begin(), triangles.end()) {}

  // Returns most, or the distance of a point if that is greater.
  double farther(const glm::dvec3& p, const glm::dvec2& uv, double most) {
    double least = distance(all_[last_], p, uv);  // neighbors in the list are close to each other
    for (std::size_t i = 0; i < all_.size() && least > most; ++i) {
      const double reach = all_[i].radius + least;
      if (squared(p - all_[i].center) >= reach * reach) continue;
      const double own = distance(all_[i], p, uv);
      if (own < least) least = own, last_ = i;
    }
    return std::max(most, least);
  }

 private:
  static double distance(const measured_triangle& t, const glm::dvec3& p, const glm::dvec2& uv) {
    const weights nearest = nearest_of(t, p);
    return std::sqrt(squared(p - t.place(nearest))) + way_along(t, uv - t.uv(nearest));
  }

  std::vector<measured_triangle> all_;
  std::size_t last_ = 0;
};

double farthest(std::span<const surface_triangle> from, measured_surface& to, double most) {
  constexpr double third = 1.0 / 3.0;
  constexpr weights samples[] = {
      {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {third, third, third}};
  for (const surface_triangle& t : from) {
    const measured_triangle own(t);
    for (const weights& w : samples) most = to.farther(own.place(w), own.uv(w), most);
  }
  return most;
}

}  // namespace

double surface_distance(std::span<const surface_triangle> a, std::span<const surface_triangle> only_a,
                        std::span<const surface_triangle> b, std::span<const surface_triangle> only_b) {
  measured_surface to_a(a), to_b(b);
  return farthest(only_b, to_a, farthest(only_a, to_b, 0.0));
}

}  // namespace sightcell::scene
