#include "stream/short_number.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sightcell::bake {

double short_number(float value) {
  constexpr float largest = std::numeric_limits<float>::max();
  value = std::clamp(value, -largest, largest);
  std::array<char, 32> text{};
  const char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double out = 0.0;
  std::from_chars(text.data(), end, out);
  return out;
}

nlohmann::ordered_json short_json(float value) {
  constexpr float all_integers_below = 16'777'216.0f;
  if (std::abs(value) < all_integers_below && std::trunc(value) == value) return static_cast<std::int64_t>(value);
  return short_number(value);
}

}  // namespace sightcell::bake
