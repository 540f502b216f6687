#pragma once
// Loops that use several threads only when they are long: threads that work on different cells would disturb each other
// in short ones.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>

namespace sightcell::bake {

// Loops of up to this length run on the calling thread.
constexpr std::size_t long_loop = 1 << 14;

// Calls body(begin, end) for ranges that together are 0 .. count - 1, on several threads if count is large.
template <class Body>
void in_blocks(std::size_t count, const Body& body) {
  if (count <= long_loop) {
    body(std::size_t{0}, count);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, long_loop / 4),
                    [&](const auto& range) { body(range.begin(), range.end()); });
}

// Sorts, on several threads if there are many items.
// less: no two items may be equal for it. Then the result does not depend on the algorithm.
template <class Item, class Less>
void sort_without_ties(Item& items, const Less& less) {
  if (items.size() <= long_loop)
    std::sort(items.begin(), items.end(), less);
  else
    tbb::parallel_sort(items.begin(), items.end(), less);
}

}  // namespace sightcell::bake
