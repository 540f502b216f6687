#include "mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "random.h"

namespace sightcell::city {
namespace {

constexpr std::array<std::array<double, 2>, 6> hexagon = {{{1, 0},
                                                           {0.5, -0.8660254037844386},
                                                           {-0.5, -0.8660254037844386},
                                                           {-1, 0},
                                                           {-0.5, 0.8660254037844386},
                                                           {0.5, 0.8660254037844386}}};

constexpr double golden = 1.618033988749895;
constexpr std::array<std::array<double, 3>, 12> icosahedron_corners = {{{-1, golden, 0},
                                                                        {1, golden, 0},
                                                                        {-1, -golden, 0},
                                                                        {1, -golden, 0},
                                                                        {0, -1, golden},
                                                                        {0, 1, golden},
                                                                        {0, -1, -golden},
                                                                        {0, 1, -golden},
                                                                        {golden, 0, -1},
                                                                        {golden, 0, 1},
                                                                        {-golden, 0, -1},
                                                                        {-golden, 0, 1}}};
constexpr std::array<std::array<std::uint8_t, 3>, 20> icosahedron_faces = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

glm::dvec3 unit_length(const glm::dvec3& v) {
  return v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

// Where a-b and c-d, taken as lines, meet.
glm::dvec2 intersection(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  const glm::dvec2 r = b - a;
  const glm::dvec2 s = d - c;
  const double t = ((c.x - a.x) * s.y - (c.y - a.y) * s.x) / (r.x * s.y - r.y * s.x);
  return a + r * t;
}

// True when some edge of a has all of b on its outer side.
bool separated_by_edge(const ring& a, const ring& b) {
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec2 n = outward_normal(a[k], a[(k + 1) % 4]);
    bool all_outside = true;
    for (const glm::dvec2& p : b) all_outside = all_outside && glm::dot(p - a[k], n) >= 0.0;
    if (all_outside) return true;
  }
  return false;
}

}  // namespace

std::uint64_t mesh::polygon_count() const {
  std::uint64_t count = 0;
  for (const primitive& p : primitives_) count += p.indices.size() / 3;
  return count;
}

primitive& mesh::of(surface material) {
  for (primitive& p : primitives_) {
    if (p.material == material) return p;
  }
  primitives_.push_back({material, {}, {}});
  return primitives_.back();
}

void mesh::triangle(surface material, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  primitive& p = of(material);
  for (const glm::dvec3& corner : {a, b, c}) {
    const glm::dvec3 local = corner - origin_;
    p.indices.push_back(static_cast<std::uint32_t>(p.positions.size()));
    p.positions.push_back({static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)});
  }
}

void mesh::quad(surface material, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  primitive& p = of(material);
  const auto first = static_cast<std::uint32_t>(p.positions.size());
  for (const glm::dvec3& corner : {a, b, c, d}) {
    const glm::dvec3 local = corner - origin_;
    p.positions.push_back({static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)});
  }
  for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) p.indices.push_back(first + corner);
}

void mesh::box(surface material, const glm::dvec3& center, const glm::dvec3& ax, const glm::dvec3& ay,
               const glm::dvec3& az) {
  const auto corner = [&](int x, int y, int z) {
    return center + ax * static_cast<double>(x) + ay * static_cast<double>(y) + az * static_cast<double>(z);
  };
  quad(material, corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1));
  quad(material, corner(1, -1, -1), corner(-1, -1, -1), corner(-1, 1, -1), corner(1, 1, -1));
  quad(material, corner(1, -1, 1), corner(1, -1, -1), corner(1, 1, -1), corner(1, 1, 1));
  quad(material, corner(-1, -1, -1), corner(-1, -1, 1), corner(-1, 1, 1), corner(-1, 1, -1));
  quad(material, corner(-1, 1, 1), corner(1, 1, 1), corner(1, 1, -1), corner(-1, 1, -1));
  quad(material, corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1));
}

void mesh::upright_box(surface material, const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 half = (high - low) * 0.5;
  box(material, low + half, {half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z});
}

void mesh::prism(surface material, const ring& base, double low, double high) {
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec2& a = base[k];
    const glm::dvec2& b = base[(k + 1) % 4];
    quad(material, at_height(a, low), at_height(b, low), at_height(b, high), at_height(a, high));
  }
  quad(material, at_height(base[0], high), at_height(base[1], high), at_height(base[2], high),
       at_height(base[3], high));
  quad(material, at_height(base[3], low), at_height(base[2], low), at_height(base[1], low), at_height(base[0], low));
}

void mesh::column(surface material, const glm::dvec3& base, double bottom_radius, double top_radius, double height) {
  const auto corner = [&base](std::size_t k, double radius, double y) {
    return base + glm::dvec3(hexagon[k % 6][0] * radius, y, hexagon[k % 6][1] * radius);
  };
  for (std::size_t k = 0; k < 6; ++k) {
    const glm::dvec3 a = corner(k, bottom_radius, 0);
    const glm::dvec3 b = corner(k + 1, bottom_radius, 0);
    if (top_radius > 0) {
      quad(material, a, b, corner(k + 1, top_radius, height), corner(k, top_radius, height));
    } else {
      triangle(material, a, b, base + glm::dvec3(0, height, 0));
    }
  }
  for (std::size_t k = 1; k + 1 < 6; ++k) {
    triangle(material, corner(0, bottom_radius, 0), corner(k + 1, bottom_radius, 0), corner(k, bottom_radius, 0));
    if (top_radius <= 0) continue;
    triangle(material, corner(0, top_radius, height), corner(k, top_radius, height), corner(k + 1, top_radius, height));
  }
}

void mesh::blob(surface material, const glm::dvec3& center, const glm::dvec3& radius, bool fine, std::uint64_t seed) {
  std::vector<glm::dvec3> corners;
  for (const auto& c : icosahedron_corners) corners.push_back(unit_length({c[0], c[1], c[2]}));
  std::vector<std::array<std::size_t, 3>> faces;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
  const auto middle = [&](std::size_t a, std::size_t b) {
    const auto [it, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)}, corners.size());
    if (is_new) corners.push_back(unit_length(corners[a] + corners[b]));
    return it->second;
  };
  for (const auto& f : icosahedron_faces) {
    const std::size_t a = f[0], b = f[1], c = f[2];
    if (!fine) {
      faces.push_back({a, b, c});
      continue;
    }
    const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    faces.insert(faces.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  random_stream random{seed};
  for (glm::dvec3& corner : corners) corner = center + corner * radius * random.range(0.78, 1.0);
  for (const auto& f : faces) triangle(material, corners[f[0]], corners[f[1]], corners[f[2]]);
}

glm::dvec3 at_height(const glm::dvec2& plan, double y) {
  return {plan.x, y, plan.y};
}

glm::dvec2 unit_vector(const glm::dvec2& v) {
  return v / std::sqrt(v.x * v.x + v.y * v.y);
}

glm::dvec2 outward_normal(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = unit_vector(b - a);
  return {-along.y, along.x};
}

ring inset(const ring& r, const std::array<double, 4>& distance) {
  std::array<std::array<glm::dvec2, 2>, 4> lines;
  for (std::size_t k = 0; k < 4; ++k) {
    const glm::dvec2 shift = outward_normal(r[k], r[(k + 1) % 4]) * -distance[k];
    lines[k] = {r[k] + shift, r[(k + 1) % 4] + shift};
  }
  ring out;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& before = lines[(k + 3) % 4];
    out[k] = intersection(before[0], before[1], lines[k][0], lines[k][1]);
  }
  return out;
}

glm::dvec2 centroid(const ring& r) {
  return (r[0] + r[1] + r[2] + r[3]) * 0.25;
}

bool overlap(const ring& a, const ring& b) {
  return !separated_by_edge(a, b) && !separated_by_edge(b, a);
}

}  // namespace sightcell::city
