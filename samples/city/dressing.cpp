#include "dressing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "ground.h"

namespace sightcell::city {
namespace {

double length_of(const glm::dvec2& v) {
  return std::sqrt(v.x * v.x + v.y * v.y);
}

}  // namespace

// A cell keeps free of everything but the ground; those with a tree may have things standing about as well.
bool dresser::is_free(const glm::dvec3& at, double reach, bool on_ground) const {
  for (const named_cell& cell : cells_) {
    if (cell.has_tree && on_ground) continue;
    const double r = reach + 0.3;
    if (at.x > cell.min.x - r && at.x < cell.max.x + r && at.z > cell.min.z - r && at.z < cell.max.z + r &&
        at.y < cell.max.y + 1.0 && at.y > cell.min.y - 2.5) {
      return false;
    }
  }
  return true;
}

void dresser::wish(std::vector<clutter_wish>& out, clutter kind, const glm::dvec3& at, const glm::dvec2& along,
                   double size, double chance, double lift, urgency when) {
  const std::uint64_t seed = random_.next();
  if (!random_.chance(chance * style_.dressing)) return;
  const bool on_ground = kind >= clutter::fruit_crate && kind <= clutter::drain;
  if (!is_free(at + glm::dvec3(0, lift, 0), clutter_reach(kind), on_ground)) return;
  out.push_back({{kind, at, along, size, seed}, when});
}

void dresser::dress_house(const building& house, std::vector<clutter_wish>& out) {
  for (const facade& f : house.facades) dress_facade(house, f, out);
  dress_roof(house, out);
}

void dresser::dress_facade(const building& house, const facade& f, std::vector<clutter_wish>& out) {
  const glm::dvec2 a = house.footprint()[f.edge], b = house.footprint()[(f.edge + 1) % 4];
  const double length = length_of(b - a), lift = house.lift;
  const glm::dvec2 along = (b - a) / length, middle = (a + b) * 0.5;
  const bool is_street = f.edge == 0;
  if (length < 2.5) return;
  wish(out, clutter::gutter, at_height(middle, house.eaves()), along, length - 0.1, 1.0, lift, urgency::needed);
  if (!house.is_over_passage()) {
    wish(out, clutter::downpipe, at_height(a + along * 0.3, house.eaves() - 0.1), along, house.eaves() + 0.3, 0.9, lift,
         urgency::needed);
    if (random_.chance(0.06)) {
      for (double s = 1.4; s < length - 1.2; s += 2.4) {
        wish(out, clutter::scaffold, at_height(a + along * s, 0), along, house.eaves(), 1.0, lift);
      }
    }
  }
  const bool is_ornate = random_.chance(is_street ? 0.7 : 0.25);
  const auto bays = static_cast<int>(length / 2.9);
  for (int i = 0; i < bays && is_ornate; ++i) {
    const double s = length * (i + 0.5) / bays, width = length / bays;
    wish(out, clutter::dentils, at_height(a + along * s, house.eaves() - 0.14), along, width, 0.9, lift);
    for (std::uint32_t row = 1; row < house.floors(); ++row) {
      const glm::dvec3 at = at_height(a + along * s, house.row_height(row) - 0.2);
      wish(out, row % 2 == 0 ? clutter::rosettes : clutter::dentils, at, along, width, 0.55, lift);
    }
  }
  const glm::dvec3 cable = at_height(middle, house.row_height(1) + random_.range(-0.2, 0.3));
  for (const double above : {0.0, 0.35, 3.3}) {
    wish(out, clutter::wall_cable, cable + glm::dvec3(0, above, 0), along, length - 0.4, 0.8, lift);
  }
  for (std::uint32_t row = 0; row < house.floors() && !f.cells.empty(); ++row) {
    for (std::uint32_t column = 0; column < house.columns(f.edge); ++column) dress_window(house, f, row, column, out);
  }
}

void dresser::dress_window(const building& house, const facade& f, std::uint32_t row, std::uint32_t column,
                           std::vector<clutter_wish>& out) {
  if (f.cells[std::size_t{row} * house.columns(f.edge) + column] == window_level::none) return;
  const window_place w = house.place_of_window(f, row, column);
  const double middle = (w.low + w.high) * 0.5, width = 2.0 * w.half, lift = house.lift;
  const bool is_street = f.edge == 0;
  if (row == 0 && column == f.door) {
    wish(out, clutter::door_things, at_height(w.middle, w.low), w.along, 1.0, 1.0, lift, urgency::needed);
    wish(out, clutter::wall_lamp, at_height(w.middle + w.along * 1.05, 2.6), w.along, 1.0, 0.7, lift);
    return;
  }
  const std::size_t cell = std::size_t{row} * house.columns(f.edge) + column;
  if (row == 0) {
    wish(out, clutter::grille, at_height(w.middle, middle), w.along, width, 0.7, lift);
    if (!is_street) return;
    wish(out, clutter::awning, at_height(w.middle, w.high + 0.25), w.along, width + 0.3, 0.3, lift);
    wish(out, clutter::hanging_sign, at_height(w.middle + w.along * (w.half + 0.25), w.high + 0.4), w.along, 1.0, 0.2,
         lift);
    return;
  }
  if (!f.balconies[cell]) {
    wish(out, clutter::shutters, at_height(w.middle, middle), w.along, width, 0.45, lift);
    wish(out, clutter::flower_box, at_height(w.middle, w.low + 0.1), w.along, width, is_street ? 0.35 : 0.2, lift);
  }
  if (!is_street) wish(out, clutter::laundry, at_height(w.middle, middle + 0.2), w.along, 2.0, 0.08, lift);
}

void dresser::dress_roof(const building& house, std::vector<clutter_wish>& out) {
  const double eaves = house.eaves(), rise = house.ridge_height();
  const glm::dvec2 along = unit_vector(house.footprint()[1] - house.footprint()[0]);
  const glm::dvec2 left = house.inside(0, 0.5), right = house.inside(1, 0.5);
  const double length = length_of(right - left);
  const bool tiled = house.roof() == surface::roof_tile;
  if (house.is_pitched()) {
    for (double s = 1.6; s < length - 1.4; s += 2.9) {
      wish(out, clutter::ridge_tiles, at_height(left + unit_vector(right - left) * s, eaves + rise), along, tiled, 0.8,
           house.lift);
    }
    for (int i = 0; i < 6; ++i) {
      // Loose tiles lie flat on neither slope: they are taken for dormer steps and snow guards near the ridge.
      const double deep = random_.range(0.44, 0.56), u = random_.range(0.15, 0.85);
      const double y = eaves + rise * (1.0 - std::abs(deep - 0.5) * 2.0) + 0.02;
      wish(out, clutter::loose_tiles, at_height(house.inside(u, deep), y), along, tiled, 0.25, house.lift);
    }
  }
  if (house.has_chimney) {
    const double top = eaves + (house.is_pitched() ? rise + 0.9 : 1.6);
    wish(out, clutter::chimney_pots, at_height(house.inside(0.3, 0.55), top), along, 1.0, 0.9, house.lift);
  }
  const glm::dvec2 mast = house.inside(random_.range(0.55, 0.8), 0.5);
  wish(out, clutter::antenna, at_height(mast, eaves + rise), along, 1.0, 0.9, house.lift);
}

void dresser::dress_tower(const tower& t, std::vector<clutter_wish>& out) {
  const double rows = (t.podium_high() - std::max(0.0, t.podium_low())) / tower::storey;
  for (const std::size_t edge : {std::size_t{0}, std::size_t{2}}) {
    dress_bays(t, t.podium(), edge, std::max(0.0, t.podium_low()), static_cast<std::uint32_t>(rows), true, out);
  }
  if (!t.has_body()) return;
  for (std::size_t edge = 0; edge < 4; ++edge) dress_bays(t, t.body(), edge, t.podium_high(), t.floors(), false, out);
  const glm::dvec2 along = unit_vector(t.body()[1] - t.body()[0]);
  for (int i = 0; i < 4; ++i) {
    const glm::dvec2 at = place_in(t.body(), 0.12);
    wish(out, i < 3 ? clutter::antenna : clutter::chimney_pots, at_height(at, t.roof()), along, 1.0, 0.7, t.lift);
  }
}

void dresser::dress_bays(const tower& t, const ring& r, std::size_t edge, double low, std::uint32_t rows,
                         bool is_podium, std::vector<clutter_wish>& out) {
  const glm::dvec2 a = r[edge], b = r[(edge + 1) % 4];
  const double length = length_of(b - a);
  if (length < 1.8) return;
  const glm::dvec2 along = (b - a) / length;
  const auto bays = static_cast<std::uint32_t>(std::max(1.0, std::floor(length / 4.0)));
  const double width = length / bays;
  const bool is_gable = edge % 2 == 1;
  for (std::uint32_t column = 0; column < bays; ++column) {
    const bool has_pipe = random_.chance(0.35), has_balconies = !is_podium && !is_gable && random_.chance(0.3);
    for (std::uint32_t row = 0; row < rows; ++row) {
      const glm::dvec3 at = at_height(a + along * (width * (column + 0.5)), low + tower::storey * (row + 0.5));
      wish(out, clutter::bay_panels, at, along, width, 0.95, t.lift, urgency::needed);
      wish(out, clutter::bay_window, at, along, width, is_gable ? 0.4 : 0.85, t.lift, urgency::needed);
      wish(out, clutter::stain, at, along, width, 0.2, t.lift);
      wish(out, clutter::vent, at, along, width, 0.7, t.lift);
      const glm::dvec3 sill = at - glm::dvec3(0, 0.62, 0);
      wish(out, clutter::flower_box, sill, along, width * 0.6, 0.25, t.lift);
      wish(out, clutter::dentils, at + glm::dvec3(0, 1.45, 0), along, width, 0.35, t.lift);
      if (has_pipe) wish(out, clutter::pipe, at, along, width, 1.0, t.lift);
      if (is_podium) {
        if (edge == 0) wish(out, clutter::shop_sign, at + glm::dvec3(0, 0.9, 0), along, width, 0.45, t.lift);
        if (edge == 0 && row == 0)
          wish(out, clutter::awning, at + glm::dvec3(0, 1.2, 0), along, width - 0.2, 0.4, t.lift);
        continue;
      }
      if (column == 0 && !is_gable) wish(out, clutter::ledge, at, along, width, 0.4, t.lift);
      wish(out, clutter::air_conditioner, at, along, width, is_gable ? 0.35 : 0.6, t.lift);
      if (has_balconies) {
        wish(out, clutter::balcony, at, along, width, 0.95, t.lift);
      } else {
        wish(out, clutter::cage, at, along, width, 0.2, t.lift);
        wish(out, clutter::laundry, at, along, width, 0.4, t.lift);
      }
    }
  }
}

glm::dvec2 dresser::place_in(const ring& where, double rim) {
  const double u = random_.range(rim, 1.0 - rim), v = random_.range(rim, 1.0 - rim);
  const glm::dvec2 a = where[0] + (where[1] - where[0]) * u, b = where[3] + (where[2] - where[3]) * u;
  return a + (b - a) * v;
}

}  // namespace sightcell::city
