#pragma once
// How the level of a texture changes from one cell to the next (SPEC.md, "Texture residency").
//
// The state of a texture is the number of its last level, and whether the cell needs the texture. A change is a number:
// 0 means that the cell needs what the one before did not, or the other way round; an odd number d that the level is (d
// + 1) / 2 quarters coarser; an even one that it is d / 2 finer. After the latter two the texture is needed.
#include <cstdint>

#include "sightcell/format/residency_table.h"

namespace sightcell::format {

inline constexpr std::uint8_t not_needed = 0x80;  // the other bits are the last level
inline constexpr std::uint8_t state_at_begin = not_needed | level_zero;

[[nodiscard]] constexpr std::uint8_t level_of_state(std::uint8_t state) noexcept {
  return (state & not_needed) != 0 ? no_level : state;
}

// Returns whether the number is one that the texture can have. coarsest: of the texture.
[[nodiscard]] constexpr bool apply_change(std::uint32_t change, std::uint8_t coarsest, std::uint8_t& state) noexcept {
  if (change == 0) {
    state ^= not_needed;
    return true;
  }
  const std::uint32_t last = state & ~not_needed;
  const std::uint32_t quarters = change / 2 + change % 2;
  const bool coarser = change % 2 == 1;
  if (coarser ? quarters > coarsest || last + quarters > coarsest : quarters + finest_level > last) return false;
  state = static_cast<std::uint8_t>(coarser ? last + quarters : last - quarters);
  return true;
}

// Returns the number of the change to a level, and makes it. Must differ from the level of the state.
[[nodiscard]] constexpr std::uint32_t change_to(std::uint8_t level, std::uint8_t& state) noexcept {
  const std::uint8_t last = state & static_cast<std::uint8_t>(~not_needed);
  if (level == no_level || level == last) {
    state ^= not_needed;
    return 0;
  }
  state = level;
  return level > last ? 2u * (level - last) - 1u : 2u * (last - level);
}

}  // namespace sightcell::format
