#include "reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>
#include <random>
#include <tuple>

namespace sightcell::test {
namespace {

using glm::dvec2;
using glm::dvec3;

class dice {
 public:
  explicit dice(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  dvec3 on_sphere() {
    const double z = 2.0 * uniform() - 1.0, angle = 2.0 * std::numbers::pi * uniform();
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  dvec3 in_triangle(const std::array<dvec3, 3>& p) {
    double u = uniform(), v = uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    return p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
  }

 private:
  std::mt19937_64 engine_;
};

double distance_to_segment(const dvec3& p, const dvec3& a, const dvec3& b) {
  const dvec3 along = b - a;
  const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
  return glm::length(p - (a + t * along));
}

double distance_to_triangle(const dvec3& p, const std::array<dvec3, 3>& c) {
  const dvec3 n = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
  bool above = true;  // the triangle
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 &a = c[i], &b = c[(i + 1) % 3];
    above = above && glm::dot(glm::cross(b - a, p - a), n) >= 0.0;
    least = std::min(least, distance_to_segment(p, a, b));
  }
  return above ? std::abs(glm::dot(p - c[0], n)) : least;
}

// Bilinear between texel centers, repeated beyond 0 and 1.
double texel_alpha(const scene::alpha_map& map, dvec2 uv) {
  const double x = uv.x * map.width - 0.5, y = uv.y * map.height - 0.5;
  const auto texel = [&](double column, double row) {
    const auto wrapped = [](double at, std::uint32_t size) {
      return static_cast<std::size_t>(at - std::floor(at / size) * size);
    };
    return map.texels[wrapped(row, map.height) * map.width + wrapped(column, map.width)] / 255.0;
  };
  const double column = std::floor(x), row = std::floor(y), fx = x - column, fy = y - row;
  return (texel(column, row) * (1 - fx) + texel(column + 1, row) * fx) * (1 - fy) +
         (texel(column, row + 1) * (1 - fx) + texel(column + 1, row + 1) * fx) * fy;
}

// Two directions across a line.
std::array<dvec3, 2> across(const dvec3& direction) {
  const dvec3 aside = std::abs(direction.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
  const dvec3 first = glm::normalize(glm::cross(direction, aside));
  return {first, glm::cross(direction, first)};
}

}  // namespace

brute_force::brute_force(const scene::scene& s, const seeing_rules& rules) : rules_(rules) {
  for (const scene::draw& d : s.draws) add_draw(s, d, rules);
  find_duplicates();
}

void brute_force::add_draw(const scene::scene& s, const scene::draw& d, const seeing_rules& rules) {
  const scene::geometry& g = s.geometries[d.geometry];
  const scene::material m = d.material == scene::no_index ? scene::material{} : s.materials[d.material];
  const bool animated = d.tags.animated && rules.animated != scene::animated_as::rest;
  const bool coarse = d.lod_object != scene::no_index && d.lod_level > 0;
  const bool left_out = d.tags.dynamic || d.tags.never || (animated && rules.animated == scene::animated_as::dynamic);
  surface p;
  p.mode = m.alpha;
  p.double_sided = m.double_sided || rules.all_double_sided;
  p.alpha = static_cast<double>(m.base_color.a);
  p.cutoff = static_cast<double>(m.alpha_cutoff);
  if (m.alpha == scene::alpha_mode::mask && m.alpha_map != scene::no_index) p.map = &s.alpha_maps[m.alpha_map];
  p.always = d.tags.always || animated;
  p.non_occluder = !d.tags.occluder || d.tags.group != scene::no_index || animated;
  const bool mirrored = glm::determinant(glm::dmat3(d.to_world)) < 0.0;
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    const std::array<std::size_t, 3> corner = {g.indices[i], g.indices[i + (mirrored ? 2 : 1)],
                                               g.indices[i + (mirrored ? 1 : 2)]};
    for (std::size_t k = 0; k < 3; ++k) {
      // World positions are floats by definition: rounded once.
      p.corners[k] = dvec3(glm::vec3(dvec3(d.to_world * glm::dvec4(dvec3(g.positions[corner[k]]), 1.0))));
      p.uvs[k] = g.uvs.empty() ? dvec2(0.0) : dvec2(g.uvs[corner[k]]);
    }
    p.normal = glm::cross(p.corners[1] - p.corners[0], p.corners[2] - p.corners[0]);
    p.absent = left_out || coarse || !(glm::dot(p.normal, p.normal) > 0.0);
    const auto id = static_cast<std::uint32_t>(surfaces_.size());
    surfaces_.push_back(p);
    if (d.lod_object == scene::no_index) continue;
    auto object =
        std::find_if(levels_.begin(), levels_.end(), [&](const detail_levels& l) { return l.object == d.lod_object; });
    if (object == levels_.end()) object = levels_.insert(object, detail_levels{d.lod_object, {}, {}});
    if (!coarse) object->finest.push_back(id);
    if (coarse && !left_out) object->coarser.push_back(id);
  }
}

// Same corners, kind and facing. Two MASK polygons that face opposite ways are taken as double-sided: so for MASK and
// for what is double-sided the facing does not count.
void brute_force::find_duplicates() {
  const auto sorted = [](const surface& p) {
    std::array<std::array<double, 3>, 3> c{};
    for (std::size_t k = 0; k < 3; ++k) c[k] = {p.corners[k].x, p.corners[k].y, p.corners[k].z};
    std::sort(c.begin(), c.end());
    return c;
  };
  for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
    for (std::uint32_t k = 0; k < surfaces_.size(); ++k) {
      const surface &a = surfaces_[i], &b = surfaces_[k];
      if (i == k || a.absent || b.absent || sorted(a) != sorted(b)) continue;
      if (std::tie(a.mode, a.double_sided, a.non_occluder) != std::tie(b.mode, b.double_sided, b.non_occluder))
        continue;
      const bool both_ways = a.double_sided || a.mode == scene::alpha_mode::mask;
      if (both_ways || glm::dot(a.normal, b.normal) > 0.0) surfaces_[i].same.push_back(k);
    }
  }
}

// Along the ray, ignoring sidedness and mask; Moeller and Trumbore's test.
static bool cross_point(const std::array<dvec3, 3>& c, const dvec3& eye, const dvec3& direction, double& distance,
                        double& u, double& v) {
  const dvec3 first = c[1] - c[0], second = c[2] - c[0], p = glm::cross(direction, second);
  const double determinant = glm::dot(first, p);
  if (determinant == 0.0) return false;
  const dvec3 from = eye - c[0], q = glm::cross(from, first);
  u = glm::dot(from, p) / determinant;
  v = glm::dot(direction, q) / determinant;
  distance = glm::dot(second, q) / determinant;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
}

bool brute_force::is_there(const surface& p, double u, double v) const {
  if (p.mode != scene::alpha_mode::mask) return true;
  const dvec2 uv = (1.0 - u - v) * p.uvs[0] + u * p.uvs[1] + v * p.uvs[2];
  return p.alpha * (p.map ? texel_alpha(*p.map, uv) : 1.0) >= p.cutoff;
}

// Rule 1.
bool brute_force::meets(const surface& p, const dvec3& eye, const dvec3& direction, double& distance) const {
  if (p.absent || (!p.double_sided && glm::dot(p.normal, direction) >= 0.0)) return false;
  double u = 0.0, v = 0.0;
  return cross_point(p.corners, eye, direction, distance, u, v) && is_there(p, u, v);
}

bool brute_force::blocked(const dvec3& eye, const dvec3& direction, double before) const {
  double distance = 0.0;
  return std::any_of(surfaces_.begin(), surfaces_.end(), [&](const surface& p) {
    return p.occludes() && meets(p, eye, direction, distance) && distance < before;
  });
}

// Rule 3.
bool brute_force::through_crack(const dvec3& eye, const dvec3& direction, double distance) const {
  const double before = distance - std::max(0.02, 0.01 * distance), gap = rules_.smallest_gap;
  if (!(gap > 0.0) || before <= 0.0) return false;
  const auto [right, up] = across(direction);
  for (const double degrees : {0.0, 45.0, 90.0, 135.0}) {
    const double angle = glm::radians(degrees);
    const dvec3 aside = gap * (std::cos(angle) * right + std::sin(angle) * up);
    if (blocked(eye + aside, direction, before) && blocked(eye - aside, direction, before)) return true;
  }
  return false;
}

void brute_force::look(const dvec3& eye, const dvec3& direction, ray_view& out) const {
  out = {};
  std::vector<hit> hits;
  for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
    double distance = 0.0;
    if (!meets(surfaces_[i], eye, direction, distance)) continue;
    hits.push_back({distance, i});
    if (surfaces_[i].occludes()) out.distance = std::min(out.distance, distance);
  }
  const double near = std::max(0.0002, 2e-5 * out.distance);
  const bool front_in_crack = std::isfinite(out.distance) && through_crack(eye, direction, out.distance);
  for (const hit& h : hits) {
    if (std::isfinite(out.distance) && std::abs(h.distance - out.distance) <= near) {
      if (!front_in_crack) out.front.push_back(h.polygon);
    } else if (h.distance < out.distance && !through_crack(eye, direction, h.distance)) {
      out.before.push_back(h.polygon);
    }
  }
  const auto add_same = [&](std::vector<std::uint32_t>& list) {
    for (std::size_t i = 0, n = list.size(); i < n; ++i)
      for (const std::uint32_t other : surfaces_[list[i]].same)
        if (std::find(list.begin(), list.end(), other) == list.end()) list.push_back(other);
  };
  add_same(out.front);
  add_same(out.before);
}

double brute_force::backs(const dvec3& place) const {
  int votes = 0, back = 0;
  for (int i = 0; i < 64; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 64.0, r = std::sqrt(1.0 - z * z);
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const dvec3 direction(r * std::cos(angle), r * std::sin(angle), z);
    double nearest = std::numeric_limits<double>::infinity();
    const surface* end = nullptr;
    for (const surface& p : surfaces_) {
      double distance = 0.0, u = 0.0, v = 0.0;
      if (p.absent || !cross_point(p.corners, place, direction, distance, u, v) || !is_there(p, u, v)) continue;
      if (distance < nearest) nearest = distance, end = &p;
    }
    if (!end || end->mode != scene::alpha_mode::opaque || end->double_sided) continue;
    ++votes;
    back += glm::dot(end->normal, direction) > 0.0;
  }
  return votes == 0 ? 0.0 : static_cast<double>(back) / votes;
}

bool brute_force::is_free(const dvec3& place) const {
  for (const surface& p : surfaces_)
    if (!p.absent && distance_to_triangle(place, p.corners) < rules_.player_radius) return false;
  return backs(place) <= 0.1;
}

bool brute_force::faces(std::uint32_t polygon, const dvec3& eye) const {
  const surface& p = surfaces_[polygon];
  const double side = glm::dot(p.normal, eye - p.corners[0]);
  return side > 0.0 || (p.double_sided && side != 0.0);
}

// No plane parts them: of the box's faces, of the triangle, or along an edge of both.
bool brute_force::touches(std::uint32_t polygon, const place_box& box) const {
  const surface& p = surfaces_[polygon];
  const dvec3 center = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
  const auto parted = [&](const dvec3& axis) {
    const double reach = glm::dot(half, glm::abs(axis));
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const dvec3& corner : p.corners) {
      const double at = glm::dot(corner - center, axis);
      low = std::min(low, at), high = std::max(high, at);
    }
    return low > reach || high < -reach;
  };
  const std::array<dvec3, 3> sides = {dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 1)};
  if (parted(p.normal)) return false;
  for (const dvec3& side : sides) {
    if (parted(side)) return false;
    for (std::size_t i = 0; i < 3; ++i)
      if (parted(glm::cross(side, p.corners[(i + 1) % 3] - p.corners[i]))) return false;
  }
  return true;
}

template <typename Each>
std::uint64_t brute_force::for_free_places(const place_box& grown, const seeing_effort& effort, Each each) const {
  dice random(effort.seed);
  const int n = effort.strata;
  const dvec3 step = (grown.max - grown.min) / static_cast<double>(n);
  std::uint64_t eyes = 0;
  for (int pass = 0; pass < effort.passes; ++pass)
    for (int i = 0; i < n * n * n; ++i) {
      const dvec3 at{i % n + random.uniform(), i / n % n + random.uniform(), i / n / n + random.uniform()};  // in order
      const dvec3 eye = grown.min + at * step;
      if (!is_free(eye)) continue;
      ++eyes;
      each(eye, random);
    }
  return eyes;
}

seen_polygons brute_force::see(const place_box& grown, const seeing_effort& effort) const {
  seen_polygons out;
  out.hits.resize(surfaces_.size());
  out.aimed.resize(surfaces_.size());
  out.inside.resize(surfaces_.size());
  out.told.resize(surfaces_.size());
  std::vector<std::uint32_t> touching;
  for (std::uint32_t i = 0; i < surfaces_.size(); ++i)
    if (!surfaces_[i].absent && touches(i, grown)) touching.push_back(i);
  ray_view view;
  const auto count = [&](std::vector<std::uint64_t>& counts) {
    for (const std::uint32_t polygon : view.front) ++counts[polygon];
    for (const std::uint32_t polygon : view.before) ++counts[polygon];
  };
  out.eyes = for_free_places(grown, effort, [&](const dvec3& eye, dice& random) {
    for (const std::uint32_t polygon : touching)
      if (faces(polygon, eye)) out.inside[polygon] = true;
    for (int i = 0; i < effort.directions; ++i) {
      look(eye, random.on_sphere(), view);
      count(out.hits);
    }
    for (const surface& p : surfaces_) {
      if (p.absent) continue;
      for (int i = 0; i < effort.aims_per_polygon; ++i) {
        look(eye, glm::normalize(random.in_triangle(p.corners) - eye), view);
        count(out.aimed);
      }
    }
  });
  out.rays = out.eyes * static_cast<std::uint64_t>(effort.directions);
  add_told(out);
  return out;
}

// Rules 2 and 6: what is in the set because something else is, or in any case.
void brute_force::add_told(seen_polygons& out) const {
  for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
    const surface& p = surfaces_[i];
    if (p.always && !p.absent) out.told[i] = true;
    if (out.inside[i])
      for (const std::uint32_t other : p.same) out.inside[other] = true;
  }
  for (const detail_levels& object : levels_) {
    const auto in = [&](std::uint32_t polygon) { return out.belongs(polygon); };
    if (std::any_of(object.finest.begin(), object.finest.end(), in))
      for (const std::uint32_t polygon : object.coarser) out.told[polygon] = true;
  }
}

double brute_force::error_of(const std::vector<std::uint32_t>& set, const place_box& grown,
                             const seeing_effort& effort) const {
  std::vector<bool> has(surfaces_.size());
  for (const std::uint32_t polygon : set) has[polygon] = true;
  const auto in = [&](std::uint32_t polygon) { return has[polygon]; };
  std::uint64_t wrong = 0;
  ray_view view;
  const std::uint64_t eyes = for_free_places(grown, effort, [&](const dvec3& eye, dice& random) {
    for (int i = 0; i < effort.directions; ++i) {
      look(eye, random.on_sphere(), view);
      const bool front_right = view.front.empty() || std::any_of(view.front.begin(), view.front.end(), in);
      wrong += !front_right || !std::all_of(view.before.begin(), view.before.end(), in);
    }
  });
  return static_cast<double>(wrong) / (static_cast<double>(eyes) * effort.directions);
}

}  // namespace sightcell::test
