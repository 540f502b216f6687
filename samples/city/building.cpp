#include "building.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightcell::city {
namespace {

constexpr double recess_depth = 0.28;

glm::dvec2 mix(const glm::dvec2& a, const glm::dvec2& b, double t) {
  return a + (b - a) * t;
}

double length_of(const glm::dvec2& v) {
  return std::sqrt(v.x * v.x + v.y * v.y);
}

}  // namespace

building::building(std::string name, const lot& place, const house_style& style, random_stream& random)
    : name_(std::move(name)), footprint_(place.footprint), is_over_passage_(place.is_over_passage), base_(style.base) {
  const bool plain = style.plain;
  const double depth = length_of(footprint_[3] - footprint_[0]);
  const double setback = place.front_setback / depth;
  const ring lot_ring = footprint_;
  footprint_[0] = mix(lot_ring[0], lot_ring[3], setback);
  footprint_[1] = mix(lot_ring[1], lot_ring[2], setback);
  const double back = random.range(0.0, 0.12);
  footprint_[2] = mix(lot_ring[2], lot_ring[1], back);
  footprint_[3] = mix(lot_ring[3], lot_ring[0], back);

  floors_ = style.floors_low + random.below(style.floors_more);
  floor_height_ = random.range(3.0, 3.4);
  if (plain) {
    ground_floor_ += (floors_ - 1) * floor_height_;
    floors_ = 1;
  }
  if (is_over_passage_) {
    base_ = passage_head_room;
    ground_floor_ = base_ + 0.7;
  }
  pitched_ = random.chance(0.7);
  ridge_height_ = random.range(2.4, 4.6);
  wall_ = static_cast<surface>(random.below(6));
  roof_ = random.chance(0.65) ? surface::roof_tile : surface::roof_slate;
  for (std::size_t i = 0; i < 2; ++i) {
    facade& f = facades[i];
    f.edge = i * 2;
    const double length = length_of(footprint_[(f.edge + 1) % 4] - footprint_[f.edge]);
    if (!plain) columns_[f.edge] = static_cast<std::uint32_t>(std::max(1.0, std::floor(length / 2.9)));
    const std::size_t cells = fits_window(f.edge) && !plain ? std::size_t{columns_[f.edge]} * floors_ : 0;
    f.cells.assign(cells, window_level::none);
    f.balconies.assign(cells, false);
    if (cells != 0 && !is_over_passage_) f.door = random.below(columns_[f.edge]);
  }
}

bool building::fits_window(std::size_t edge) const {
  const double length = length_of(footprint_[(edge + 1) % 4] - footprint_[edge]);
  return length / columns_[edge] >= 2.2;
}

double building::row_height(std::uint32_t row) const {
  return row == 0 ? base_ : ground_floor_ + (row - 1) * floor_height_;
}

// The ends are the very corners, so that the walls of two edges meet without a gap.
glm::dvec2 building::column_point(std::size_t edge, std::uint32_t column) const {
  const glm::dvec2& a = footprint_[edge];
  const glm::dvec2& b = footprint_[(edge + 1) % 4];
  if (column == 0) return a;
  if (column == columns_[edge]) return b;
  return mix(a, b, static_cast<double>(column) / columns_[edge]);
}

std::uint64_t building::window_cost(window_level level) {
  switch (level) {
    case window_level::recess:
      return 16;  // frame 8, reveals 8, plate 2, less the plain wall's 2
    case window_level::pane:
      return 2;
    case window_level::sill:
      return box_cost;
    case window_level::bars:
      return 2 * box_cost;
    default:
      return 0;
  }
}

glm::dvec2 building::inside(double along, double deep) const {
  return mix(mix(footprint_[0], footprint_[1], along), mix(footprint_[3], footprint_[2], along), deep);
}

std::uint64_t building::base_cost() const {
  std::uint64_t around = 0;
  for (std::size_t edge = 0; edge < 4; ++edge) around += columns_[edge];
  const std::uint64_t roof = pitched_ ? columns_[0] + columns_[2] + 4 : around;
  return 2 * around * floors_ + around + roof;
}

mesh building::build() const {
  // Houses have their own origin, on a grid that floats hold exactly.
  const glm::dvec2 center = centroid(footprint_);
  mesh m(name_, {std::floor(center.x * 16.0) / 16.0, 0.0, std::floor(center.y * 16.0) / 16.0});
  for (std::size_t edge = 0; edge < 4; ++edge) build_wall(m, edge);
  build_bottom(m);
  if (pitched_) {
    build_pitched_roof(m);
  } else {
    build_flat_roof(m);
  }
  build_extras(m);
  return m;
}

void building::build_wall(mesh& m, std::size_t edge) const {
  const facade* with_cells = nullptr;
  for (const facade& f : facades) {
    if (f.edge == edge && !f.cells.empty()) with_cells = &f;
  }
  for (std::uint32_t row = 0; row < floors_; ++row) {
    for (std::uint32_t column = 0; column < columns_[edge]; ++column) {
      if (with_cells != nullptr) {
        build_cell(m, *with_cells, row, column);
        continue;
      }
      const glm::dvec2 a = column_point(edge, column), b = column_point(edge, column + 1);
      const double low = row_height(row), high = row_height(row + 1);
      m.quad(wall_, at_height(a, low), at_height(b, low), at_height(b, high), at_height(a, high));
    }
  }
}

void building::build_cell(mesh& m, const facade& f, std::uint32_t row, std::uint32_t column) const {
  const glm::dvec2 a = column_point(f.edge, column), b = column_point(f.edge, column + 1);
  const double low = row_height(row), high = row_height(row + 1);
  const std::array<glm::dvec3, 4> cell = {at_height(a, low), at_height(b, low), at_height(b, high), at_height(a, high)};
  const std::size_t index = std::size_t{row} * columns_[f.edge] + column;
  const window_level level = f.cells[index];
  if (level == window_level::none) {
    m.quad(wall_, cell[0], cell[1], cell[2], cell[3]);
    return;
  }
  build_window(m, level, row == 0 && column == f.door, cell, place_of_window(f, row, column), f.balconies[index]);
}

window_place building::place_of_window(const facade& f, std::uint32_t row, std::uint32_t column) const {
  const glm::dvec2 left = column_point(f.edge, column), right = column_point(f.edge, column + 1);
  const double width = length_of(right - left);
  const bool is_ground = row == 0, is_door = is_ground && column == f.door;
  window_place out;
  out.along = (right - left) / width;
  out.out = outward_normal(left, right);
  out.middle = (left + right) * 0.5;
  out.half = is_door ? 0.7 : is_ground ? std::min(1.3, width * 0.5 - 0.45) : 0.6;
  // The ground floor's walls may begin below the ground.
  out.low = is_door ? slab_height + 0.03 : (is_ground ? building_base + 1.0 : row_height(row) + 0.85);
  out.high = is_ground ? 3.1 : row_height(row) + 2.55;
  return out;
}

// cell: low left, low right, high right, high left, as seen from outside.
void building::build_window(mesh& m, window_level level, bool is_door, const std::array<glm::dvec3, 4>& cell,
                            const window_place& place, bool has_balcony) const {
  const glm::dvec2 along = place.along, out = place.out, middle = place.middle;
  const double half = place.half, low = place.low, high = place.high;
  const auto opening = [&](double depth) {
    const glm::dvec2 l = middle - along * half - out * depth, r = middle + along * half - out * depth;
    return std::array<glm::dvec3, 4>{at_height(l, low), at_height(r, low), at_height(r, high), at_height(l, high)};
  };
  const std::array<glm::dvec3, 4> edge = opening(0.0), plate = opening(recess_depth);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    m.quad(wall_, cell[k], cell[next], edge[next], edge[k]);
    m.quad(wall_, edge[k], edge[next], plate[next], plate[k]);
  }
  m.quad(is_door ? surface::wood : surface::window, plate[0], plate[1], plate[2], plate[3]);
  const glm::dvec3 x(along.x, 0, along.y), y(0, 1, 0), z(out.x, 0, out.y);
  if (level >= window_level::pane) {
    const std::array<glm::dvec3, 4> pane = opening(0.1);
    m.quad(surface::glass, pane[0], pane[1], pane[2], pane[3]);
  }
  if (level >= window_level::sill) {
    m.box(surface::stone, at_height(middle + out * 0.06, is_door ? high + 0.1 : low - 0.06), x * (half + 0.12),
          y * 0.06, z * 0.13);
  }
  if (level >= window_level::bars) {
    const glm::dvec2 at = middle - out * 0.17;
    m.box(surface::paint, at_height(at, (low + high) * 0.5), x * 0.03, y * ((high - low) * 0.5), z * 0.03);
    m.box(surface::paint, at_height(at, low + (high - low) * 0.68), x * half, y * 0.03, z * 0.03);
  }
  if (!has_balcony) return;
  const double floor_level = low - 0.18, reach = 1.1, side = half + 0.5;
  m.box(surface::stone, at_height(middle + out * (reach * 0.5 - 0.02), floor_level - 0.08), x * side, y * 0.08,
        z * (reach * 0.5));
  const auto corner = [&](double s, double d, double h) {
    return at_height(middle + along * s + out * d, floor_level + h);
  };
  const double d = reach - 0.06, s = side - 0.04;
  m.quad(surface::fence, corner(-s, d, 0), corner(s, d, 0), corner(s, d, 0.95), corner(-s, d, 0.95));
  m.quad(surface::fence, corner(s, d, 0), corner(s, 0, 0), corner(s, 0, 0.95), corner(s, d, 0.95));
  m.quad(surface::fence, corner(-s, 0, 0), corner(-s, d, 0), corner(-s, d, 0.95), corner(-s, 0, 0.95));
}

// Caps are fans around the middle: all points of an edge lie on one line, so a fan from a corner would have polygons
// without area.
void building::build_bottom(mesh& m) const {
  const glm::dvec3 center = at_height(centroid(footprint_), base_);
  for (std::size_t edge = 0; edge < 4; ++edge) {
    for (std::uint32_t column = 0; column < columns_[edge]; ++column) {
      m.triangle(wall_, center, at_height(column_point(edge, column + 1), base_),
                 at_height(column_point(edge, column), base_));
    }
  }
}

void building::build_flat_roof(mesh& m) const {
  const glm::dvec3 center = at_height(centroid(footprint_), eaves());
  for (std::size_t edge = 0; edge < 4; ++edge) {
    for (std::uint32_t column = 0; column < columns_[edge]; ++column) {
      m.triangle(surface::roof_slate, center, at_height(column_point(edge, column), eaves()),
                 at_height(column_point(edge, column + 1), eaves()));
    }
  }
}

// The ridge runs from party wall to party wall; every column's top edge takes the nearer end of it.
void building::build_pitched_roof(mesh& m) const {
  const double top = eaves() + ridge_height_;
  const glm::dvec3 right = at_height(mix(footprint_[1], footprint_[2], 0.5), top);
  const glm::dvec3 left = at_height(mix(footprint_[3], footprint_[0], 0.5), top);
  for (const std::size_t edge : {std::size_t{0}, std::size_t{2}}) {
    const glm::dvec3& near_start = edge == 0 ? left : right;
    const glm::dvec3& near_end = edge == 0 ? right : left;
    const std::uint32_t half = (columns_[edge] + 1) / 2;
    for (std::uint32_t column = 0; column < columns_[edge]; ++column) {
      m.triangle(roof_, at_height(column_point(edge, column), eaves()),
                 at_height(column_point(edge, column + 1), eaves()), column < half ? near_start : near_end);
    }
    m.triangle(roof_, at_height(column_point(edge, half), eaves()), near_end, near_start);
  }
  m.triangle(wall_, at_height(footprint_[1], eaves()), at_height(footprint_[2], eaves()), right);
  m.triangle(wall_, at_height(footprint_[3], eaves()), at_height(footprint_[0], eaves()), left);
}

void building::build_extras(mesh& m) const {
  const glm::dvec2 along = unit_vector(footprint_[1] - footprint_[0]);
  const glm::dvec2 out = outward_normal(footprint_[0], footprint_[1]);
  const glm::dvec3 x(along.x, 0, along.y), y(0, 1, 0), z(out.x, 0, out.y);
  const double width = length_of(footprint_[1] - footprint_[0]);
  for (std::uint32_t i = 0; i < cornices; ++i) {
    m.box(surface::stone, at_height(mix(footprint_[0], footprint_[1], 0.5) + out * 0.04, row_height(i + 1) + 0.02),
          x * (width * 0.5), y * 0.1, z * 0.12);
  }
  if (has_chimney) {
    const double top = eaves() + (pitched_ ? ridge_height_ + 0.9 : 1.6);
    m.box(pitched_ ? surface::stone : surface::metal, at_height(inside(0.3, 0.55), (eaves() - 0.2 + top) * 0.5),
          x * (pitched_ ? 0.45 : 1.0), y * ((top - eaves() + 0.2) * 0.5), z * (pitched_ ? 0.35 : 0.7));
  }
  if (has_penthouse) {
    m.prism(wall_, {inside(0.06, 0.22), inside(0.94, 0.22), inside(0.94, 0.9), inside(0.06, 0.9)}, eaves() - 0.1,
            eaves() + 2.8);
  }
}

}  // namespace sightcell::city
