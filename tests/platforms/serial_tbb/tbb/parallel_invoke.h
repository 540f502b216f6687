#pragma once
// Replaces oneTBB where the platform has no such library. Makes one call after the other.

namespace tbb {

template <class... Call>
void parallel_invoke(const Call&... call) {
  (call(), ...);
}

}  // namespace tbb
