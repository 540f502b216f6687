#pragma once
// Sets as the difference to a reference set, in its rank space (SPEC.md, "Rows"): what is removed is counted
// among the members of the reference alone, what is added among the numbers that are no members. Both lists are shorter
// that way than they are among all numbers, and their gaps smaller. rank_encoder.h is the way back.
//
// Lists are their borders here: the first number of a run and the one behind its last, run by run; strictly ascending.
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::format {

// Stands behind the last border of a list of differences, so many times.
inline constexpr std::uint32_t no_border = 0xFFFFFFFFu;
inline constexpr std::size_t list_padding = 3;

// Numbers that apply_rank_difference may write for lists of so many numbers (what is behind their borders not counted).
[[nodiscard]] constexpr std::size_t rank_difference_room(std::size_t reference, std::size_t removed,
                                                         std::size_t added) noexcept {
  return reference + removed + added + 4;
}

// reference without `removed` (ranks among its members) and with `added` (ranks among the numbers below limit that are
// no members) -> the borders of the set, in out[0 .. count). reference: a set below limit. removed and added: of an
// even number of borders, and then list_padding times no_border; whatever they are besides, nothing is read or written elsewhere. out:
// rank_difference_room() numbers, not overlapping the others. limit below no_border. False, and count 0, when a rank is
// beyond the last one. Allocates nothing. O(borders of all three).
[[nodiscard]] bool apply_rank_difference(std::span<const std::uint32_t> reference,
                                         std::span<const std::uint32_t> removed, std::span<const std::uint32_t> added,
                                         std::uint32_t limit, std::span<std::uint32_t> out,
                                         std::size_t& count) noexcept;

}  // namespace sightcell::format
