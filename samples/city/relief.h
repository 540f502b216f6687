#pragma once
// The ground's height over the town: smooth hills and hollows, the same on every machine.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sightcell::city {

class relief {
 public:
  relief() = default;  // flat, at 0
  // height: between the lowest and the highest ground, at most; length: from a hill to the next hollow, about.
  relief(double height, double length, std::uint64_t seed) : height_(height), length_(length), seed_(seed) {}

  double at(const glm::dvec2& plan) const;
  glm::dvec3 normal(const glm::dvec2& plan) const;  // unit, upwards

 private:
  double noise(const glm::dvec2& p, std::uint64_t octave) const;

  double height_ = 0.0, length_ = 1.0;
  std::uint64_t seed_ = 0;
};

}  // namespace sightcell::city
