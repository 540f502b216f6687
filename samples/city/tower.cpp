#include "tower.h"

#include <cmath>

namespace sightcell::city {
namespace {

double length_of(const glm::dvec2& v) {
  return std::sqrt(v.x * v.x + v.y * v.y);
}

}  // namespace

tower::tower(std::string name, const lot& place, const style& s, random_stream& random)
    : name_(std::move(name)), podium_(place.footprint) {
  static constexpr std::array<surface, 4> walls = {surface::concrete, surface::plaster_grey, surface::plaster_rose,
                                                   surface::plaster_cream};
  podium_high_ = 6.0 + 1.5 * random.below(3);
  wall_ = walls[random.below(4)];
  has_tank_ = random.chance(0.6);
  const double front = random.range(0.5, 2.5), back = random.range(0.3, 2.0), side = random.range(0.2, 1.0);
  const std::uint32_t floors = s.floors_low + random.below(s.floors_more);
  if (place.is_over_passage) {
    podium_low_ = passage_head_room;
    return;
  }
  // Corner lots narrow towards the yard: no tower where too little would be left of it.
  const double shortest = std::min(length_of(podium_[1] - podium_[0]), length_of(podium_[3] - podium_[2]));
  if (shortest < 2.0 * side + 1.5) return;
  body_ = inset(podium_, {front, side, back, side});
  floors_ = floors;
}

mesh tower::build() const {
  const glm::dvec2 center = centroid(podium_);
  mesh m(name_, {std::floor(center.x * 16.0) / 16.0, 0.0, std::floor(center.y * 16.0) / 16.0});
  m.prism(wall_, podium_, podium_low_, podium_high_);
  if (!has_body()) return m;
  m.prism(wall_, body_, podium_high_ - 0.2, roof());
  const ring core = inset(body_, {2.0, 1.2, 2.0, 1.2});
  if (length_of(core[2] - core[3]) > 1.0) m.prism(surface::plaster_grey, core, roof() - 0.2, roof() + 3.0);
  if (has_tank_) m.column(surface::rust, at_height(centroid(body_), roof() + 2.9), 1.1, 1.1, 1.8);
  return m;
}

}  // namespace sightcell::city
