#pragma once
// A scene whose shadows are cast by what a camera does not see.
#include <cstdint>
#include <vector>

#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

// A camera at (0, 1.5, 2) sees a floor through the gap below a wall. Roofs behind the wall, which it does not see, cast
// shadows there at noon. One more is beside the floor.
struct court {
  std::uint32_t floor = 0, wall = 0, near_roof = 0, far_roof = 0, unseen_roof = 0;
  tiny_scene tiny;
  std::vector<std::uint32_t> camera;  // what the camera sees

  court() {
    floor = tiny.quad({-20, 0, 20}, {20, 0, 20}, {20, 0, -20}, {-20, 0, -20});
    wall = tiny.quad({-20, 2, -2}, {20, 2, -2}, {20, 30, -2}, {-20, 30, -2}, {scene::alpha_mode::opaque, true});
    near_roof = tiny.quad({-3, 6, -4}, {3, 6, -4}, {3, 6, -8}, {-3, 6, -8});
    far_roof = tiny.quad({-3, 9, -10}, {3, 9, -10}, {3, 9, -14}, {-3, 9, -14});
    unseen_roof = tiny.quad({-3, 9, -60}, {3, 9, -60}, {3, 9, -64}, {-3, 9, -64});
    camera = {floor, floor + 1, wall, wall + 1};
  }
};

}  // namespace sightcell::test
