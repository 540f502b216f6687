#include "relief.h"

#include <cmath>

#include "random.h"

namespace sightcell::city {
namespace {

enum : std::uint64_t { stream_relief = 20 };

double smooth(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

}  // namespace

// Value noise: random heights on a lattice, blended so that slopes have no kinks.
double relief::noise(const glm::dvec2& p, std::uint64_t octave) const {
  const double x0 = std::floor(p.x), z0 = std::floor(p.y);
  const auto corner = [&](double dx, double dz) {
    random_stream random{seed_, stream_relief, octave, static_cast<std::uint64_t>(static_cast<std::int64_t>(x0 + dx)),
                         static_cast<std::uint64_t>(static_cast<std::int64_t>(z0 + dz))};
    return random.unit();
  };
  const double u = smooth(p.x - x0), v = smooth(p.y - z0);
  const double low = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * u;
  const double high = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * u;
  return low + (high - low) * v;
}

double relief::at(const glm::dvec2& plan) const {
  if (height_ == 0.0) return 0.0;
  return height_ * (0.85 * noise(plan / length_, 0) + 0.15 * noise(plan / (length_ * 0.37), 1) - 0.5);
}

glm::dvec3 relief::normal(const glm::dvec2& plan) const {
  const double x = (at(plan + glm::dvec2(1, 0)) - at(plan - glm::dvec2(1, 0))) * 0.5;
  const double z = (at(plan + glm::dvec2(0, 1)) - at(plan - glm::dvec2(0, 1))) * 0.5;
  const double length = std::sqrt(1.0 + x * x + z * z);
  return {-x / length, 1.0 / length, -z / length};
}

}  // namespace sightcell::city
