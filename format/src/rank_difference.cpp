#include "rank_difference.h"

namespace sightcell::format {
namespace {

// Numbers that are all members of the reference, or all not.
struct segment {
  std::uint32_t begin = 0;  // first number
  std::uint32_t rank = 0;   // its rank
  std::uint32_t end = 0;    // rank behind the last one
  bool kept = false;        // such numbers are in the set where the list does not hold them
};

// A list is where it is: inside one of its runs where the number of borders behind it is odd. So is what is written.
// Which segment has a border of a list inside no processor can foresee; all but the second one and more in a segment is
// done without a jump.
class border_writer {
 public:
  explicit border_writer(std::uint32_t* out) noexcept : out_(out) {}

  // at: borders of the list before the segment, and then behind it; below list.size(), whose last number is no_border.
  void put(const segment& s, const std::uint32_t* list, std::size_t& at) noexcept {
    at += static_cast<std::size_t>(list[at] == s.rank);
    change_to((at & 1u) != static_cast<std::size_t>(s.kept), s.begin);
    out_[count_] = s.begin + (list[at] - s.rank);
    const auto inside = static_cast<std::size_t>(list[at] < s.end);
    count_ += inside;
    at += inside;
    for (; list[at] < s.end; ++at) out_[count_++] = s.begin + (list[at] - s.rank);
  }
  void change_to(bool inside, std::uint32_t place) noexcept {
    out_[count_] = place;
    count_ += (count_ & 1u) ^ static_cast<std::size_t>(inside);
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  std::uint32_t* out_;
  std::size_t count_ = 0;
};

}  // namespace

// At most one border is written at the begin of every segment, of which there are one more than borders of the
// reference, one at the limit, and one for every border of a list: what rank_difference_room says. A border that turns
// out to be none is written over by the next.
bool apply_rank_difference(std::span<const std::uint32_t> reference, std::span<const std::uint32_t> removed,
                           std::span<const std::uint32_t> added, std::uint32_t limit, std::span<std::uint32_t> out,
                           std::size_t& count) noexcept {
  count = 0;
  if (removed.empty() || added.empty() || removed.back() != no_border || added.back() != no_border) return false;
  if (out.size() < rank_difference_room(reference.size(), removed.size() - 1, added.size() - 1)) return false;
  border_writer writer(out.data());
  std::size_t gone = 0;
  std::size_t come = 0;
  std::uint32_t members = 0;  // before the segment at hand
  std::uint32_t place = 0;
  for (std::size_t i = 0; i + 1 < reference.size(); i += 2) {
    const std::uint32_t first = reference[i];
    const std::uint32_t end = reference[i + 1];
    if (place != first) writer.put({place, place - members, first - members, false}, added.data(), come);
    writer.put({first, members, members + (end - first), true}, removed.data(), gone);
    members += end - first;
    place = end;
  }
  if (place != limit) writer.put({place, place - members, limit - members, false}, added.data(), come);
  writer.change_to(false, limit);
  // A list may end at the very end, which is in no segment.
  gone += static_cast<std::size_t>(removed[gone] == members);
  come += static_cast<std::size_t>(added[come] == limit - members);
  if (removed[gone] != no_border || added[come] != no_border) return false;
  count = writer.count();
  return true;
}

}  // namespace sightcell::format
