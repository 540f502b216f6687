#pragma once
// --safety-ring: conservative dilation of finished cell sets. bake.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sightcell::bake {

// Which polygons join a finished set without a visibility test. Polygons that face away from all of the grown cell do
// not join.
enum class safety_ring : std::uint8_t {
  none,
  edge,   // polygons that share an edge with a member
  vertex  // polygons that share a vertex with a member
};

// As the command line and the settings text call them, in the order of the values.
inline constexpr std::array<std::string_view, 3> safety_ring_names = {"none", "edge", "vertex"};

// Returns the value with this name, nothing for an unknown name.
constexpr std::optional<safety_ring> safety_ring_of(std::string_view name) {
  for (std::size_t i = 0; i < safety_ring_names.size(); ++i)
    if (safety_ring_names[i] == name) return static_cast<safety_ring>(i);
  return std::nullopt;
}

}  // namespace sightcell::bake
