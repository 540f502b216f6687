#pragma once
// Loops that are worth several threads only when they are long.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>

namespace sightcell::bake {

constexpr std::size_t long_loop = 1 << 14;

// Calls body(begin, end) for stretches that together are 0 .. count - 1; in this thread alone if the loop is short, so
// that units which are worked on side by side do not get into each other's way.
template <class Body>
void in_blocks(std::size_t count, const Body& body) {
  if (count <= long_loop) {
    body(std::size_t{0}, count);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, long_loop / 4),
                    [&](const auto& range) { body(range.begin(), range.end()); });
}

// less must leave no ties: then the result does not depend on who sorts.
template <class Item, class Less>
void sort_without_ties(Item& items, const Less& less) {
  if (items.size() <= long_loop)
    std::sort(items.begin(), items.end(), less);
  else
    tbb::parallel_sort(items.begin(), items.end(), less);
}

}  // namespace sightcell::bake
