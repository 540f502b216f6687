#pragma once
// Replaces oneTBB where the platform has no such library. For one thread.

namespace tbb {

struct collaborative_once_flag {
  bool done = false;
};

template <class Call>
void collaborative_call_once(collaborative_once_flag& flag, const Call& call) {
  if (flag.done) return;
  call();
  flag.done = true;  // not after an exception: the next call tries again
}

}  // namespace tbb
