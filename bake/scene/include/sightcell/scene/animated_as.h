#pragma once
// What becomes of draws that an animation or a skin moves and that have no mark (draw_tags::animated).
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sightcell::scene {

enum class animated_as : std::uint8_t {
  always,  // in every set, non-occluders
  rest,    // static, in the pose that the file has them in
  dynamic  // left out: in no set, non-occluders; the host decides when to draw them
};

// As the command line and the settings text of a file call them, in the order of the values.
inline constexpr std::array<std::string_view, 3> animated_as_names = {"always", "rest", "dynamic"};

// Returns the value with this name, nothing for an unknown name.
constexpr std::optional<animated_as> animated_as_of(std::string_view name) {
  for (std::size_t i = 0; i < animated_as_names.size(); ++i)
    if (animated_as_names[i] == name) return static_cast<animated_as>(i);
  return std::nullopt;
}

}  // namespace sightcell::scene
