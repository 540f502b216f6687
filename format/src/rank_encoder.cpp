#include "rank_encoder.h"

#include <algorithm>
#include <cstdint>

namespace sightcell::format {
namespace {

// Appends, and joins runs that touch.
void put(std::vector<run>& list, std::uint64_t first, std::uint64_t count) {
  if (!list.empty() && std::uint64_t{list.back().first} + list.back().count == first) {
    list.back().count += static_cast<std::uint32_t>(count);
  } else {
    list.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
  }
}

std::uint64_t end_of(const run& r) {
  return std::uint64_t{r.first} + r.count;
}

}  // namespace

void make_rank_difference(std::span<const run> reference, std::span<const run> set, std::vector<run>& removed,
                          std::vector<run>& added) {
  removed.clear();
  added.clear();
  std::uint64_t members = 0;  // of the reference, before `place`
  std::uint64_t place = 0;
  auto r = reference.begin();
  auto s = set.begin();
  // From border to border of either set.
  while (r != reference.end() || s != set.end()) {
    const bool in_reference = r != reference.end() && r->first <= place;
    const bool in_set = s != set.end() && s->first <= place;
    std::uint64_t next = ~std::uint64_t{0};
    if (r != reference.end()) next = std::min<std::uint64_t>(next, in_reference ? end_of(*r) : r->first);
    if (s != set.end()) next = std::min<std::uint64_t>(next, in_set ? end_of(*s) : s->first);
    const std::uint64_t length = next - place;
    if (in_reference && !in_set) put(removed, members, length);
    if (in_set && !in_reference) put(added, place - members, length);
    if (in_reference) members += length;
    place = next;
    if (in_reference && place == end_of(*r)) ++r;
    if (in_set && place == end_of(*s)) ++s;
  }
}

}  // namespace sightcell::format
