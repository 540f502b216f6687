#include "shapes.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightcell::city {
namespace {

constexpr double root3_2 = 0.8660254037844386;
constexpr std::array<std::array<double, 2>, 6> hexagon = {
    {{1, 0}, {0.5, root3_2}, {-0.5, root3_2}, {-1, 0}, {-0.5, -root3_2}, {0.5, -root3_2}}};
constexpr std::array<std::array<double, 2>, 4> square = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

std::array<double, 2> corner_of(std::size_t sides, std::size_t k) {
  return sides == 4 ? square[k % 4] : hexagon[(k % sides) * (6 / sides)];
}

// Rotates by the quaternion (v, w), which need not be of unit length.
frame rotated(const frame& f, const glm::dvec3& v, double w) {
  const double length = std::sqrt(glm::dot(v, v) + w * w);
  const glm::dvec3 q = v / length;
  const double s = w / length;
  const auto turn = [&](const glm::dvec3& p) { return p + 2.0 * glm::cross(q, glm::cross(q, p) + s * p); };
  return {f.at, turn(f.x), turn(f.y), turn(f.z)};
}

}  // namespace

frame upright_frame(const glm::dvec3& at, const glm::dvec2& along) {
  return {at, {along.x, 0, along.y}, {0, 1, 0}, {-along.y, 0, along.x}};
}

frame tumbled(const frame& f, double amount, random_stream& random) {
  const double x = random.range(-amount, amount), y = random.range(-amount, amount), z = random.range(-amount, amount);
  return rotated(f, {x, y, z}, 1.0);
}

frame turned(const frame& f, double half_tangent) {
  return rotated(f, f.y * half_tangent, 1.0);
}

void crate(mesh& m, surface material, const frame& f, const glm::dvec3& half) {
  m.box(material, f.at, f.x * half.x, f.y * half.y, f.z * half.z);
}

void pillar(mesh& m, surface material, const glm::dvec3& a, const glm::dvec3& b, double radius, double end_radius,
            std::size_t sides) {
  const glm::dvec3 d = glm::normalize(b - a);
  const glm::dvec3 helper = std::abs(d.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(helper, d));
  const glm::dvec3 v = glm::cross(d, u);
  const auto point = [&](const glm::dvec3& end, double r, std::size_t k) {
    const auto c = corner_of(sides, k);
    return end + u * (c[0] * r) + v * (c[1] * r);
  };
  for (std::size_t k = 0; k < sides; ++k) {
    if (end_radius > 0) {
      m.quad(material, point(a, radius, k), point(a, radius, k + 1), point(b, end_radius, k + 1),
             point(b, end_radius, k));
    } else {
      m.triangle(material, point(a, radius, k), point(a, radius, k + 1), b);
    }
  }
  for (std::size_t k = 1; k + 1 < sides; ++k) {
    m.triangle(material, point(a, radius, 0), point(a, radius, k + 1), point(a, radius, k));
    if (end_radius > 0) {
      m.triangle(material, point(b, end_radius, 0), point(b, end_radius, k), point(b, end_radius, k + 1));
    }
  }
}

void card(mesh& m, surface material, const frame& f, double half_width, double half_height) {
  const double w = half_width, h = half_height;
  m.quad(material, f.point({-w, -h, 0}), f.point({w, -h, 0}), f.point({w, h, 0}), f.point({-w, h, 0}));
}

}  // namespace sightcell::city
