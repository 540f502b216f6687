#pragma once
// What becomes of draws that are animated and not marked (draw_tags::animated).
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sightcell::scene {

enum class animated_as : std::uint8_t {
  always,   // in every set, never hide
  rest,     // static, as they stand in the file
  dynamic,  // left out
};

// As the command line and the settings in a file call them, in the order of the values.
inline constexpr std::array<std::string_view, 3> animated_as_names = {"always", "rest", "dynamic"};

constexpr std::optional<animated_as> animated_as_of(std::string_view name) {
  for (std::size_t i = 0; i < animated_as_names.size(); ++i)
    if (animated_as_names[i] == name) return static_cast<animated_as>(i);
  return std::nullopt;
}

}  // namespace sightcell::scene
