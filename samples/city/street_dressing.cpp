// The part of the dresser that looks after streets, squares and yards.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "dressing.h"
#include "ground.h"

namespace sightcell::city {
namespace {

double length_of(const glm::dvec2& v) {
  return std::sqrt(v.x * v.x + v.y * v.y);
}

struct quaternion {
  double x, y, z, w;
};

quaternion operator*(const quaternion& a, const quaternion& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

quaternion unit(const quaternion& q) {
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return {q.x / length, q.y / length, q.z / length, q.w / length};
}

// Brings +Z to the direction, about +Y.
quaternion facing(const glm::dvec2& direction) {
  const glm::dvec2 d = unit_vector(direction);
  const double w = std::sqrt(std::max(0.0, (1.0 + d.y) * 0.5)), y = std::sqrt(std::max(0.0, (1.0 - d.y) * 0.5));
  return {0.0, d.x < 0.0 ? -y : y, 0.0, w};
}

}  // namespace

// Vehicles and furniture stand on the slope, trees and lamps upright; all a little askew.
void dresser::stand(std::vector<prop_place>& out, prop kind, const glm::dvec2& at, const glm::dvec2& direction,
                    double lift) {
  const double scale =
      kind == prop::leafy_tree || kind == prop::young_tree || kind == prop::bush ? random_.range(0.8, 1.25) : 1.0;
  const double lean = kind == prop::bicycle ? 0.12 : kind == prop::motor_car ? 0.004 : 0.015;
  const double lean_x = random_.range(-lean, lean), lean_z = random_.range(-lean, lean);
  const double height = relief_.at(at) + lift;
  if (!is_free(at_height(at, height), prop_radius(kind) * scale, true)) return;
  for (const prop_place& other : out) {
    const double apart = prop_radius(other.kind) * other.scale + prop_radius(kind) * scale;
    if (glm::dot(other.at - at, other.at - at) < apart * apart) return;
  }
  prop_place place;
  place.kind = kind;
  place.at = at;
  place.base = height;
  place.scale = scale;
  const bool upright = kind == prop::leafy_tree || kind == prop::young_tree || kind == prop::street_lamp ||
                       kind == prop::bush || kind == prop::fountain;
  const glm::dvec3 n = upright ? glm::dvec3(0, 1, 0) : relief_.normal(at);
  const quaternion q = unit(unit({n.z + lean_x, 0.0, -n.x + lean_z, 1.0 + n.y}) * facing(direction));
  place.turn = {q.y, q.w};
  place.tilt = {q.x, q.z};
  out.push_back(place);
}

void dresser::furnish(const block& b, std::vector<prop_place>& out) {
  const std::size_t before = out.size();
  if (b.is_square) {
    // Holds its place against the others; the town has one of its own there already.
    prop_place fountain;
    fountain.kind = prop::fountain;
    fountain.at = centroid(b.yard);
    out.push_back(fountain);
  }
  const glm::dvec2 any(0.3, 1.0);
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const glm::dvec2 from = b.outline[edge], to = b.outline[(edge + 1) % 4];
    const double length = length_of(to - from);
    const glm::dvec2 along = (to - from) / length, out_normal = outward_normal(from, to);
    const double pavement = glm::dot(b.pavement[edge] - from, out_normal);
    const bool beside_sunken = (edge == 3 && b.is_sunken_low) || (edge == 1 && b.is_sunken_high);
    for (double s = 4.0; s < length - 3.0; s += 3.6) {
      const glm::dvec2 at = from + along * (s + random_.range(-0.8, 0.8));
      const glm::dvec2 rim = at + out_normal * (pavement - 0.5);
      const double pick = random_.unit();
      if (pavement < 1.2) {
        if (pick < 0.2) stand(out, prop::bicycle, at + out_normal * 0.45, along, slab_height);
        continue;
      }
      if (pick < 0.2) {
        stand(out, prop::street_lamp, rim, along, slab_height);
      } else if (pick < 0.38) {
        stand(out, prop::young_tree, rim, any, slab_height);
      } else if (pick < 0.48) {
        stand(out, prop::bicycle, rim, along, slab_height);
      } else if (pick < 0.56) {
        stand(out, prop::cafe_table, at + out_normal * 1.0, along, slab_height);
      } else if (pick < 0.78 && !beside_sunken && pavement > 1.6) {
        stand(out, prop::motor_car, at + out_normal * (pavement + 1.15), along, 0.0);
      } else if (pick < 0.84) {
        stand(out, prop::bench, rim, out_normal, slab_height);
      } else if (pick < 0.87) {
        stand(out, prop::barrow, rim, along + out_normal * 0.4, slab_height);
      }
    }
  }
  for (int i = 0; i < (b.is_square ? 26 : 16); ++i) {
    const glm::dvec2 at = place_in(b.yard, 0.14);
    const glm::dvec2 direction{random_.range(-1.0, 1.0), random_.range(0.2, 1.0)};
    const double pick = random_.unit();
    if (b.is_square) {
      const prop kind = pick < 0.4    ? prop::leafy_tree
                        : pick < 0.7  ? prop::fruit_stall
                        : pick < 0.85 ? prop::cafe_table
                                      : prop::bench;
      stand(out, kind, at, direction, slab_height);
    } else {
      const prop kind = pick < 0.35   ? prop::leafy_tree
                        : pick < 0.5  ? prop::young_tree
                        : pick < 0.75 ? prop::bush
                        : pick < 0.85 ? prop::barrow
                        : pick < 0.95 ? prop::bicycle
                                      : prop::crate;
      stand(out, kind, at, direction, slab_height);
    }
  }
  if (b.is_square) out.erase(out.begin() + static_cast<std::ptrdiff_t>(before));
}

void dresser::dress_street(const plan& p, const block& b, std::vector<clutter_wish>& out) {
  scatter(b.yard, b.is_square ? 90 : 70, slab_height, out);
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const std::size_t next = (edge + 1) % 4;
    scatter({b.pavement[edge], b.pavement[next], b.outline[next], b.outline[edge]}, 34, slab_height, out);
    const bool beside_sunken = (edge == 3 && b.is_sunken_low) || (edge == 1 && b.is_sunken_high);
    if (!beside_sunken) scatter({b.tile[edge], b.tile[next], b.pavement[next], b.pavement[edge]}, 12, 0.0, out);
    const glm::dvec2 along = unit_vector(b.outline[next] - b.outline[edge]);
    for (int i = 0; i < 3 && !b.is_square; ++i) {
      const double s = random_.range(0.1, 0.9);
      const glm::dvec2 at = b.outline[edge] + (b.outline[next] - b.outline[edge]) * s;
      wish(out, clutter::planks, at_height(at, relief_.at(at) + slab_height), along, 1.0, 0.5);
    }
  }
  if (b.is_sunken_low) dress_sunken_edge(sunken_edge(b, true), b.column % 2 == 0, out);
  if (b.is_sunken_high) dress_sunken_edge(sunken_edge(b, false), b.column % 2 == 0, out);
  hang_wires(p, b, out);
}

void dresser::scatter(const ring& where, int count, double height, std::vector<clutter_wish>& out) {
  static constexpr std::array<clutter, 10> kinds = {
      clutter::litter,      clutter::stones, clutter::fallen_leaves, clutter::pigeons, clutter::bottles,
      clutter::fruit_crate, clutter::stones, clutter::litter,        clutter::drain,   clutter::fallen_leaves};
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 at = place_in(where, 0.06);
    const clutter kind = i % 4 == 3 ? clutter::leaf : kinds[random_.below(10)];
    const glm::dvec2 along = unit_vector({random_.range(-1.0, 1.0), random_.range(0.1, 1.0)});
    wish(out, kind, at_height(at, relief_.at(at) + height), along, 1.0, 1.0, 0,
         kind == clutter::leaf ? urgency::filler : urgency::wanted);
  }
}

void dresser::dress_sunken_edge(const std::array<glm::dvec2, 2>& edge, bool has_stairs,
                                std::vector<clutter_wish>& out) {
  const double length = length_of(edge[1] - edge[0]);
  const glm::dvec2 along = (edge[1] - edge[0]) / length;
  const glm::dvec2 inward = -outward_normal(edge[0], edge[1]);
  for (double s = 7.5; s < length - 7.5; s += 2.9) {
    if (has_stairs && std::abs(s - length * 0.22) < 2.2) continue;  // the way down
    const glm::dvec2 at = edge[0] + along * s + inward * 0.2;
    const double rise = relief_.at(at + along * 1.45) - relief_.at(at - along * 1.45);
    wish(out, clutter::railing, at_height(at, relief_.at(at)), along, rise, 1.0, 0, urgency::needed);
  }
  const ring floor = {edge[0] + inward * -0.6, edge[1] + inward * -0.6, edge[1] + inward * -3.5,
                      edge[0] + inward * -3.5};
  scatter(floor, 24, -sunken_depth, out);
}

// Across the streets at the block's low-x and low-z sides, and along them for trams.
void dresser::hang_wires(const plan& p, const block& b, std::vector<clutter_wish>& out) {
  for (const std::size_t edge : {std::size_t{0}, std::size_t{3}}) {
    const bool on_rim = edge == 0 ? b.column == 0 : b.row == 0;
    if (on_rim) continue;
    const glm::dvec2 from = b.tile[edge], to = b.tile[(edge + 1) % 4];
    const glm::dvec2 along = unit_vector(to - from), across = outward_normal(from, to);
    const double width = 2.0 * std::abs(glm::dot(b.outline[edge] - from, across));
    const double length = length_of(to - from);
    for (double s = 12.0; s < length - 12.0; s += 5.0) {
      const glm::dvec2 at = from + along * (s + random_.range(-1.5, 1.5));
      const double height = relief_.at(at) + random_.range(5.6, 8.5);
      wish(out, clutter::wire, at_height(at, height), across, width + 4.0, 0.6, 0, urgency::needed);
    }
    if (width < 10.0 || p.rows < 2) continue;
    for (const double side : {-1.2, 1.2}) {
      const glm::dvec2 middle = (from + to) * 0.5 + across * side;
      const double height = std::max(relief_.at(from), relief_.at(to)) + 5.9;
      wish(out, clutter::wire, at_height(middle, height), along, length, 1.0, 0, urgency::needed);
    }
  }
}

}  // namespace sightcell::city
