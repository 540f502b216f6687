#include "cluster_bounds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <vector>

namespace gpu_driven {
namespace {

constexpr glm::vec4 no_cone(0.0f, 0.0f, 0.0f, 2.0f);

// All triangles face away from an eye that is in direction -d of the cluster if dot(d, axis) >= sin(a), where a is the
// largest angle of a normal to the axis; the shader adds the radius. Cones that are nearly half-spaces cull nothing.
glm::vec4 cone_of(const std::vector<glm::dvec3>& normals) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& n : normals) sum += n;
  const double length = glm::length(sum);
  if (normals.empty() || !(length > 1e-6)) return no_cone;
  const glm::dvec3 axis = sum / length;
  double least = 1.0;
  for (const glm::dvec3& n : normals) least = std::min(least, glm::dot(axis, n));
  if (!(least > 0.1)) return no_cone;
  return {glm::vec3(axis), static_cast<float>(std::sqrt(1.0 - least * least))};
}

}  // namespace

void set_bounds(cluster_record& out, std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners,
                const glm::dmat4& to_world, bool is_double_sided) {
  const double side = glm::determinant(glm::dmat3(to_world)) < 0.0 ? -1.0 : 1.0;
  const auto place = [&](std::uint32_t index) {
    return glm::dvec3(to_world * glm::dvec4(glm::dvec3(positions[index]), 1.0));
  };
  glm::dvec3 low(1e300), high(-1e300);
  std::vector<glm::dvec3> normals;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const glm::dvec3 a = place(corners[i]), b = place(corners[i + 1]), c = place(corners[i + 2]);
    low = glm::min(low, glm::min(a, glm::min(b, c)));
    high = glm::max(high, glm::max(a, glm::max(b, c)));
    const glm::dvec3 across = side * glm::cross(b - a, c - a);
    const double area = glm::length(across);
    if (area > 0.0) normals.push_back(across / area);  // one without area has no side, and no pixels
  }
  const glm::dvec3 center = 0.5 * (low + high);
  double radius = 0.0;
  for (const std::uint32_t index : corners) radius = std::max(radius, glm::length(place(index) - center));
  // The shaders have positions in single precision.
  const double extent = std::max(glm::length(low), glm::length(high));
  const double rounding = 1e-6 * extent;
  out.sphere = glm::vec4(glm::vec3(center), static_cast<float>(radius + rounding));
  out.min = glm::vec3(low - rounding);
  out.max = glm::vec3(high + rounding);
  out.cone = is_double_sided ? no_cone : cone_of(normals);
}

// The greatest row sum of M^T M is at least its greatest eigenvalue, the square of the greatest stretch.
double greatest_scale(const glm::dmat4& to_world) {
  const glm::dmat3 m(to_world);
  const glm::dmat3 product = glm::transpose(m) * m;
  double most = 0.0;
  for (int i = 0; i < 3; ++i)
    most = std::max(most, std::abs(product[i].x) + std::abs(product[i].y) + std::abs(product[i].z));
  return std::sqrt(most);
}

}  // namespace gpu_driven
