#pragma once
// Replaces oneTBB where the platform has no such library. Makes one call after the other.

namespace tbb {

template <class Index, class Call>
void parallel_for(Index first, Index last, const Call& call) {
  for (; first < last; ++first) call(first);
}

}  // namespace tbb
