#pragma once
// The radical inverse of which Halton (1964) made his sequence: the digits of index in a base, mirrored at the point.
#include <cstdint>

namespace sightcell::bake {

// In [0, 1).
inline float radical_inverse(std::uint32_t index, std::uint32_t base) {
  double value = 0.0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return static_cast<float>(value);
}

}  // namespace sightcell::bake
