#include "rank_difference.h"

#include <algorithm>

namespace sightcell::format {
namespace {

bool is_padded(std::span<const std::uint32_t> list) noexcept {
  if (list.size() < list_padding) return false;
  const auto padding = list.last(list_padding);
  return std::all_of(padding.begin(), padding.end(), [](std::uint32_t border) { return border == no_border; });
}

// Numbers that are all members of the reference, or all not.
struct segment {
  std::uint32_t begin = 0;  // first number
  std::uint32_t rank = 0;   // its rank
  std::uint32_t end = 0;    // one past the last rank
};

// A position in a list.
struct list_place {
  const std::uint32_t* next = nullptr;
  std::uint32_t inside = 0;  // 1 inside a run
};

// Writes the borders of the set in a segment. kept: 1 where numbers that are not in the list are in the set, else 0.
// before: 1 if the set contains the number before the segment. Returns whether it contains the last one of the segment.
//   No processor can predict which segments have borders of the list: most have none, one or two, and these cases are
//   computed without a branch. Compilers make branches of conditions here, but not of arithmetic.
inline std::uint32_t put_segment(const segment& s, std::uint32_t kept, std::uint32_t before, list_place& list,
                                 std::uint32_t*& out) noexcept {
  const std::uint32_t* next = list.next;
  const auto begins = static_cast<std::uint32_t>(next[0] == s.rank);
  const std::uint32_t first = next[0] ^ ((next[0] ^ next[1]) & (0u - begins));
  const std::uint32_t second = next[1] ^ ((next[1] ^ next[2]) & (0u - begins));
  const std::uint32_t within = static_cast<std::uint32_t>(first < s.end) + static_cast<std::uint32_t>(second < s.end);
  std::uint32_t inside = list.inside ^ begins;
  *out = s.begin;
  out += before ^ inside ^ kept;
  out[0] = s.begin + (first - s.rank);
  out[1] = s.begin + (second - s.rank);
  out += within;
  inside ^= within & 1u;
  next += begins + within;
  for (; *next < s.end; ++next) {
    *out++ = s.begin + (*next - s.rank);
    inside ^= 1u;
  }
  list = {next, inside};
  return inside ^ kept;
}

}  // namespace

// One border or none is written at the begin of each segment (there is one more segment than borders of the reference,
// and one at the limit), and one for each border of a list. Up to two more are written that the next ones overwrite.
// This gives rank_difference_room.
bool apply_rank_difference(std::span<const std::uint32_t> reference, std::span<const std::uint32_t> removed,
                           std::span<const std::uint32_t> added, std::uint32_t limit, std::span<std::uint32_t> out,
                           std::size_t& count) noexcept {
  count = 0;
  if (!is_padded(removed) || !is_padded(added)) return false;
  if (out.size() < rank_difference_room(reference.size(), removed.size() - list_padding, added.size() - list_padding))
    return false;
  list_place gone{removed.data()};
  list_place come{added.data()};
  std::uint32_t* at = out.data();
  std::uint32_t inside = 0;   // 1 if the set contains the number before place
  std::uint32_t members = 0;  // of the reference before place
  std::uint32_t place = 0;
  for (std::size_t i = 0; i + 1 < reference.size(); i += 2) {
    const std::uint32_t first = reference[i];
    const std::uint32_t end = reference[i + 1];
    if (place != first) inside = put_segment({place, place - members, first - members}, 0, inside, come, at);
    inside = put_segment({first, members, members + (end - first)}, 1, inside, gone, at);
    members += end - first;
    place = end;
  }
  if (place != limit) inside = put_segment({place, place - members, limit - members}, 0, inside, come, at);
  *at = limit;
  at += inside;
  // A list may end at the limit, which is in no segment.
  gone.next += static_cast<std::size_t>(*gone.next == members);
  come.next += static_cast<std::size_t>(*come.next == limit - members);
  if (*gone.next != no_border || *come.next != no_border) return false;
  count = static_cast<std::size_t>(at - out.data());
  return true;
}

}  // namespace sightcell::format
