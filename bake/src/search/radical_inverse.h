#pragma once
// The radical inverse, on which the sequence of Halton (1964) is based: the digits of an index in some base, mirrored
// at the point.
#include <cstdint>

namespace sightcell::bake {

// Returns a value in [0, 1).
inline float radical_inverse(std::uint32_t index, std::uint32_t base) {
  double value = 0.0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return static_cast<float>(value);
}

}  // namespace sightcell::bake
