#include "ground.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace sightcell::city {
namespace {

constexpr std::uint32_t steps = 10;  // squares along a block's side

glm::dvec2 mix(const glm::dvec2& a, const glm::dvec2& b, double t) {
  return t == 1.0 ? b : a + (b - a) * t;  // neighbors meet in the very same point
}

// u from edge 3 to edge 1, v from edge 0 to edge 2.
glm::dvec2 inside(const ring& r, double u, double v) {
  return mix(mix(r[0], r[1], u), mix(r[3], r[2], u), v);
}

void add_patch(mesh& m, surface material, const ring& outline, const relief& r, std::uint32_t nu, std::uint32_t nv,
               double lift) {
  const auto point = [&](std::uint32_t i, std::uint32_t j) {
    const glm::dvec2 at = inside(outline, static_cast<double>(i) / nu, static_cast<double>(j) / nv);
    return at_height(at, r.at(at) + lift);
  };
  for (std::uint32_t i = 0; i < nu; ++i) {
    for (std::uint32_t j = 0; j < nv; ++j) {
      m.quad(material, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
}

// A wall that follows the ground along a-b, facing outward of an edge in up order.
void add_skirt(mesh& m, surface material, const glm::dvec2& a, const glm::dvec2& b, const relief& r, std::uint32_t n,
               double low, double high) {
  for (std::uint32_t i = 0; i < n; ++i) {
    const glm::dvec2 s = mix(a, b, static_cast<double>(i) / n), e = mix(a, b, static_cast<double>(i + 1) / n);
    const double hs = r.at(s), he = r.at(e);
    m.quad(material, at_height(s, hs + low), at_height(e, he + low), at_height(e, he + high), at_height(s, hs + high));
  }
}

void add_slab(mesh& m, surface material, const ring& outline, const relief& r, std::uint32_t n, double low,
              double high) {
  add_patch(m, material, outline, r, n, n, high);
  for (std::size_t k = 0; k < 4; ++k) add_skirt(m, material, outline[k], outline[(k + 1) % 4], r, n, low, high);
}

// What is left of a tile beside its sunken streets.
ring dry_part(const block& b) {
  ring out = b.tile;
  const glm::dvec2 left = unit_vector(b.tile[1] - b.tile[0]) * sunken_half_width;
  const glm::dvec2 right = unit_vector(b.tile[2] - b.tile[3]) * sunken_half_width;
  if (b.is_sunken_low) {
    out[0] += left;
    out[3] += right;
  }
  if (b.is_sunken_high) {
    out[1] -= left;
    out[2] -= right;
  }
  return out;
}

// Down from a dry tile's edge to the sunken floor, against the wall; every step a closed box of its own.
void add_stairs(mesh& m, const std::array<glm::dvec2, 2>& edge, const relief& r) {
  const glm::dvec2 along = unit_vector(edge[1] - edge[0]), out = outward_normal(edge[0], edge[1]);
  const glm::dvec2 top = mix(edge[0], edge[1], 0.22);
  const double ground = r.at(top);
  constexpr int count = 15;
  for (int i = 0; i < count; ++i) {
    const double high = ground - 0.05 - sunken_depth * i / count;
    const glm::dvec2 a = top + along * (0.36 * i), b = a + along * 0.36;
    m.prism(surface::stone, {a + out * 1.4, b + out * 1.4, b - out * 0.1, a - out * 0.1}, ground - sunken_depth - 0.8,
            high);
  }
}

struct section {
  glm::dvec2 at;
  double low, high;
};

// A closed shell along a line, from `left` to `right` across it.
void sweep(mesh& m, surface material, const std::vector<section>& line, const glm::dvec2& across, double left,
           double right) {
  const auto ring_at = [&](const section& s) {
    const glm::dvec2 l = s.at + across * left, r = s.at + across * right;
    return std::array<glm::dvec3, 4>{at_height(l, s.low), at_height(r, s.low), at_height(r, s.high),
                                     at_height(l, s.high)};
  };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const auto a = ring_at(line[i]), b = ring_at(line[i + 1]);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      m.quad(material, a[k], b[k], b[next], a[next]);
    }
  }
  const auto first = ring_at(line.front()), last = ring_at(line.back());
  m.quad(material, first[0], first[1], first[2], first[3]);
  m.quad(material, last[3], last[2], last[1], last[0]);
}

double hump(double t) {
  const double s = 2.0 * t - 1.0;
  return 0.5 * (1.0 - s * s);
}

}  // namespace

std::array<glm::dvec2, 2> sunken_edge(const block& b, bool low_side) {
  const ring dry = dry_part(b);
  return low_side ? std::array<glm::dvec2, 2>{dry[3], dry[0]} : std::array<glm::dvec2, 2>{dry[1], dry[2]};
}

void add_street_ground(mesh& m, const plan& p, const relief& r, std::uint32_t row, std::uint32_t column,
                       const block* content) {
  const ring tile = {p.node(row, column), p.node(row + 1, column), p.node(row + 1, column + 1),
                     p.node(row, column + 1)};
  if (content == nullptr) {
    const bool is_corner_row = row == 0 || row == p.rows + 1;
    const bool is_corner_column = column == 0 || column == p.columns + 1;
    add_patch(m, surface::road, tile, r, is_corner_row ? 2 : steps, is_corner_column ? 2 : steps, 0.0);
    return;
  }
  add_patch(m, surface::road, dry_part(*content), r, steps, steps, 0.0);
  const ring dry = dry_part(*content);
  for (const bool low_side : {true, false}) {
    if (!(low_side ? content->is_sunken_low : content->is_sunken_high)) continue;
    const auto edge = sunken_edge(*content, low_side);
    if (low_side) {
      add_patch(m, surface::road, {tile[0], dry[0], dry[3], tile[3]}, r, 2, steps, -sunken_depth);
    } else {
      add_patch(m, surface::road, {dry[1], tile[1], tile[2], dry[2]}, r, 2, steps, -sunken_depth);
    }
    add_skirt(m, surface::brick, edge[0], edge[1], r, steps, -sunken_depth, 0.0);
    if (content->column % 2 == 0) add_stairs(m, edge, r);
    // The sunken street ends in a wall at the rim of the town; facing into the street.
    const glm::dvec2 left[2] = {low_side ? tile[0] : dry[1], low_side ? dry[0] : tile[1]};
    const glm::dvec2 right[2] = {low_side ? dry[3] : tile[2], low_side ? tile[3] : dry[2]};
    if (content->column == 0) add_skirt(m, surface::brick, left[1], left[0], r, 2, -sunken_depth, 0.0);
    if (content->column + 1 == p.columns) add_skirt(m, surface::brick, right[1], right[0], r, 2, -sunken_depth, 0.0);
  }
}

void add_pavement(mesh& m, const ring& outline, const relief& r) {
  add_slab(m, surface::pavement, outline, r, steps, -0.3, slab_height);
}

void add_lawn(mesh& m, const ring& outline, const relief& r) {
  add_slab(m, surface::lawn, outline, r, 6, 0.0, slab_height + 0.06);
}

double bridge_height(const bridge& b, const relief& r) {
  return 0.5 * (r.at(b.from) + r.at(b.to)) + 0.03 + hump(0.5);
}

void add_bridge(mesh& m, const bridge& b, const relief& r) {
  const glm::dvec2 along = unit_vector(b.to - b.from);
  const glm::dvec2 across(-along.y, along.x);
  const double start = r.at(b.from) + 0.03, end = r.at(b.to) + 0.03;
  std::vector<section> deck, parapet;
  constexpr int parts = 16;
  for (int i = -1; i <= parts + 1; ++i) {
    const double t = std::min(1.0, std::max(0.0, static_cast<double>(i) / parts));
    glm::dvec2 at = t <= 0.5 ? mix(b.from, b.over, t * 2.0) : mix(b.over, b.to, t * 2.0 - 1.0);
    if (i < 0) at -= along * 0.9;
    if (i > parts) at += along * 0.9;
    const double high = start + (end - start) * t + hump(t);
    const double s = 2.0 * t - 1.0;
    deck.push_back({at, high - 0.45 - 1.9 * s * s * s * s, high});
    parapet.push_back({at, high - 0.1, high + 0.95});
  }
  sweep(m, surface::stone, deck, across, -0.5 * b.width, 0.5 * b.width);
  sweep(m, surface::brick, parapet, across, -0.5 * b.width - 0.15, -0.5 * b.width + 0.15);
  sweep(m, surface::brick, parapet, across, 0.5 * b.width - 0.15, 0.5 * b.width + 0.15);
}

}  // namespace sightcell::city
