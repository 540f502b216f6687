#pragma once
// Stands in for oneTBB where no library is built for the platform: one call after the other.

namespace tbb {

template <class... Call>
void parallel_invoke(const Call&... call) {
  (call(), ...);
}

}  // namespace tbb
