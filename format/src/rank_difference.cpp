#include "rank_difference.h"

namespace sightcell::format {
namespace {

// One list of differences, and whether what it lists is so at the place at hand.
class rank_list {
 public:
  explicit rank_list(std::span<const std::uint32_t> borders) noexcept
      : at_(borders.data()), last_(borders.data() + borders.size() - 1), next_(*at_) {}

  [[nodiscard]] std::uint32_t next() const noexcept { return next_; }
  [[nodiscard]] bool inside() const noexcept { return inside_ != 0; }
  // Steps over the next border where that is true. Never over the last number, which is no_border.
  void step_if(bool really) noexcept {
    const auto one = static_cast<std::uint32_t>(really & (at_ != last_));
    at_ += one;
    inside_ ^= one;
    next_ = *at_;
  }

 private:
  const std::uint32_t* at_;
  const std::uint32_t* last_;
  std::uint32_t next_;
  std::uint32_t inside_ = 0;
};

// Numbers that are all members of the reference, or all not.
struct segment {
  std::uint32_t begin = 0;  // first number
  std::uint32_t rank = 0;   // its rank
  std::uint32_t end = 0;    // rank behind the last one
  bool kept = false;        // such numbers are in the set where the list does not hold them
};

// Most segments begin without a border of the list, about a third have one inside: what can be done without a jump is,
// since no processor can foresee these.
class border_writer {
 public:
  explicit border_writer(std::uint32_t* out) noexcept : out_(out) {}

  void put(const segment& s, rank_list& list) noexcept {
    list.step_if(list.next() == s.rank);
    change_to(list.inside() != s.kept, s.begin);
    while (list.next() < s.end) {
      out_[count_++] = s.begin + (list.next() - s.rank);
      inside_ = !inside_;
      list.step_if(true);
    }
  }
  void change_to(bool inside, std::uint32_t place) noexcept {
    out_[count_] = place;
    count_ += static_cast<std::size_t>(inside != inside_);
    inside_ = inside;
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  std::uint32_t* out_;
  std::size_t count_ = 0;
  bool inside_ = false;
};

}  // namespace

// Every segment writes at most one border at its begin, of which there are as many as borders of the reference and one,
// and every border of a list at most one: what rank_difference_room says.
bool apply_rank_difference(std::span<const std::uint32_t> reference, std::span<const std::uint32_t> removed,
                           std::span<const std::uint32_t> added, std::uint32_t limit, std::span<std::uint32_t> out,
                           std::size_t& count) noexcept {
  count = 0;
  if (removed.empty() || added.empty() || removed.back() != no_border || added.back() != no_border) return false;
  if (out.size() < rank_difference_room(reference.size(), removed.size() - 1, added.size() - 1)) return false;
  rank_list gone(removed);
  rank_list come(added);
  border_writer writer(out.data());
  std::uint32_t members = 0;  // before the segment at hand
  std::uint32_t place = 0;
  for (std::size_t i = 0; i + 1 < reference.size(); i += 2) {
    const std::uint32_t first = reference[i];
    const std::uint32_t end = reference[i + 1];
    if (place != first) writer.put({place, place - members, first - members, false}, come);
    writer.put({first, members, members + (end - first), true}, gone);
    members += end - first;
    place = end;
  }
  if (place != limit) writer.put({place, place - members, limit - members, false}, come);
  writer.change_to(false, limit);
  // A list may end at the very end, which is in no segment.
  gone.step_if(gone.next() == members);
  come.step_if(come.next() == limit - members);
  if (gone.next() != no_border || come.next() != no_border) return false;
  count = writer.count();
  return true;
}

}  // namespace sightcell::format
