#pragma once
// Stands in for oneTBB where no library is built for the platform: one call after the other.

namespace tbb {

template <class Index, class Call>
void parallel_for(Index first, Index last, const Call& call) {
  for (; first < last; ++first) call(first);
}

}  // namespace tbb
