#include "surface_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace sightcell::scene {
namespace {

glm::dvec3 nearest_of_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length = glm::dot(along, along);
  const double t = length > 0.0 ? std::clamp(glm::dot(p - a, along) / length, 0.0, 1.0) : 0.0;
  return a + t * along;
}

double squared(const glm::dvec3& v) {
  return glm::dot(v, v);
}

// The squared distance of a point to a triangle, which may have no area.
double squared_distance(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area = squared(normal);
  if (area > 0.0) {
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 edge = t[(k + 1) % 3] - t[k];
      inside = inside && glm::dot(glm::cross(edge, p - t[k]), normal) >= 0.0;
    }
    if (inside) {
      const double along = glm::dot(p - t[0], normal);
      return along * along / area;
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) least = std::min(least, squared(p - nearest_of_segment(p, t[k], t[(k + 1) % 3])));
  return least;
}

struct bounded_triangle {
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

class measured_surface {
 public:
  explicit measured_surface(std::span<const surface_triangle> triangles) {
    for (const surface_triangle& t : triangles) {
      bounded_triangle& made = all_.emplace_back();
      made.corners = {glm::dvec3(t[0]), glm::dvec3(t[1]), glm::dvec3(t[2])};
      made.center = (made.corners[0] + made.corners[1] + made.corners[2]) / 3.0;
      for (const glm::dvec3& corner : made.corners)
        made.radius = std::max(made.radius, std::sqrt(squared(corner - made.center)));
    }
  }

  // Returns most, or the distance of a point if that is greater.
  double farther(const glm::dvec3& p, double most) {
    double least = squared_distance(p, all_[last_].corners);  // neighbors in the list are close to each other
    for (std::size_t i = 0; i < all_.size() && least > most * most; ++i) {
      const double reach = all_[i].radius + std::sqrt(least);
      if (squared(p - all_[i].center) >= reach * reach) continue;
      const double distance = squared_distance(p, all_[i].corners);
      if (distance < least) least = distance, last_ = i;
    }
    return std::max(most, std::sqrt(least));
  }

 private:
  std::vector<bounded_triangle> all_;
  std::size_t last_ = 0;
};

double farthest(std::span<const surface_triangle> from, measured_surface& to, double most) {
  for (const surface_triangle& t : from) {
    const glm::dvec3 a(t[0]), b(t[1]), c(t[2]);
    for (const glm::dvec3& p : {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0})
      most = to.farther(p, most);
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
