#pragma once
// --safety-ring: what lies beside a cell set joins it, seen or not.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sightcell::bake {

enum class safety_ring : std::uint8_t {
  none,
  edge,    // polygons that share an edge with one of the set
  vertex,  // that share a vertex with one
};

// As the command line and the settings in a file call them, in the order of the values.
inline constexpr std::array<std::string_view, 3> safety_ring_names = {"none", "edge", "vertex"};

constexpr std::optional<safety_ring> safety_ring_of(std::string_view name) {
  for (std::size_t i = 0; i < safety_ring_names.size(); ++i)
    if (safety_ring_names[i] == name) return static_cast<safety_ring>(i);
  return std::nullopt;
}

}  // namespace sightcell::bake
