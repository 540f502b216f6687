#pragma once
// Sets as the difference to a reference set, in its rank space (SPEC.md, "Rows"): removed numbers are counted among the
// members of the reference, added ones among the numbers that are not members. Both lists are shorter this way than
// among all numbers, and their gaps smaller. The counterpart for writing is rank_encoder.h.
//
// Here a list is the borders of its runs: the first number of each run and the one after its last; strictly ascending.
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::format {

// Follows the last border of a list, list_padding times.
inline constexpr std::uint32_t no_border = 0xFFFFFFFFu;
inline constexpr std::size_t list_padding = 3;

// The numbers that apply_rank_difference may write for lists of these lengths (without padding).
[[nodiscard]] constexpr std::size_t rank_difference_room(std::size_t reference, std::size_t removed,
                                                         std::size_t added) noexcept {
  return reference + removed + added + 4;
}

// Computes the borders of a set: reference without `removed` (ranks among its members) and with `added` (ranks among
// the numbers below limit that are not members). The result is out[0 .. count).
// reference: a set below limit.
// removed, added: an even number of borders, then list_padding times no_border. Other contents give a wrong result, but
//   no access outside of the buffers.
// out: rank_difference_room() numbers, not overlapping the others.
// limit: below no_border.
// False, and count 0, if a rank is beyond the last one. Allocates nothing. O(borders of all three).
[[nodiscard]] bool apply_rank_difference(std::span<const std::uint32_t> reference,
                                         std::span<const std::uint32_t> removed, std::span<const std::uint32_t> added,
                                         std::uint32_t limit, std::span<std::uint32_t> out,
                                         std::size_t& count) noexcept;

}  // namespace sightcell::format
