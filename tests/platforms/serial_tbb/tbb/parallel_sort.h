#pragma once
// Replaces oneTBB where the platform has no such library. Sorts with one thread.
#include <algorithm>

namespace tbb {

template <class Iterator, class Compare>
void parallel_sort(Iterator first, Iterator last, const Compare& compare) {
  std::sort(first, last, compare);
}

}  // namespace tbb
