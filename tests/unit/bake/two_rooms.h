#pragma once
// Two rooms with a door between them, for who asks what can be seen through it.
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

// From (-6, 0, -6) to (6, 3, 6), with a wall at x = 0, and a door in it from z = -0.6 to 0.6, 2.2 m high.
inline scene::scene two_rooms() {
  tiny_scene tiny;
  tiny.closed_box({-6, 0, -6}, {6, 3, 6}, true);
  tiny.closed_box({-0.1f, 0, -6}, {0.1f, 3, -0.6f});
  tiny.closed_box({-0.1f, 0, 0.6f}, {0.1f, 3, 6});
  tiny.closed_box({-0.1f, 2.2f, -0.6f}, {0.1f, 3, 0.6f});
  return tiny.finished();
}

}  // namespace sightcell::test
