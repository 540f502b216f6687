#pragma once
// The geometry hash of a draw (SPEC.md, "Draw identity"): the same for all orders of its triangles and vertices, and
// additive, so that the parts of a split mesh have that of the whole together.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace sightcell::format {

// Mixes all bits of a number.
[[nodiscard]] constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// The part of one triangle. Those of all triangles of a draw, modulo 2^64, add up to its hash.
// corners: positions in the space of the draw. The order does not matter.
// Returns 0 if two corners are equal: importers drop these triangles.
[[nodiscard]] inline std::uint64_t triangle_hash(const std::array<std::array<float, 3>, 3>& corners) noexcept {
  std::array<std::array<std::uint32_t, 3>, 3> bits{};
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float value = corners[corner][axis];
      bits[corner][axis] = value == 0.0f ? 0u : std::bit_cast<std::uint32_t>(value);  // +0 in place of -0
    }
  }
  std::sort(bits.begin(), bits.end());
  if (bits[0] == bits[1] || bits[1] == bits[2]) return 0;
  std::uint64_t hash = 0x9E3779B97F4A7C15u;
  for (const auto& corner : bits) {
    for (const std::uint32_t axis : corner) hash = mixed(hash ^ axis);
  }
  return hash;
}

}  // namespace sightcell::format
