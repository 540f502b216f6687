#pragma once
// What a host that knows nothing of visibility would do: every polygon drawn for every face, nothing culled but backs,
// nothing read back. The measure of the gpu source on hardware.
#include <memory>

#include "bench/hemicube/world.h"

namespace sightcell::bench {

class plain_draw {
 public:
  // A context must be current, now and at every call.
  plain_draw(const world& w, std::uint32_t resolution);
  ~plain_draw();
  plain_draw(const plain_draw&) = delete;
  plain_draw& operator=(const plain_draw&) = delete;

  void render(std::span<const bake::pose> poses);  // comes back when the device is done with all of them

 private:
  struct objects;
  std::unique_ptr<objects> gl_;
  std::uint32_t resolution_;
  int index_count_;
};

}  // namespace sightcell::bench
