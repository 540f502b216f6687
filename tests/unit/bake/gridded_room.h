#pragma once
// A room whose walls are many polygons, and a scene with all that rays need, for the tests of search and bound.
#include "search/near_polygons.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"
#include "trace/viewpoints.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

// A room of 4 x 4 x 4 m around the origin whose walls are grids of n x n quads each.
inline tiny_scene gridded_room(int n) {
  tiny_scene tiny;
  const float step = 4.0f / static_cast<float>(n);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const float u = -2.0f + step * static_cast<float>(i), v = -2.0f + step * static_cast<float>(j);
          const auto at = [&](float a, float b) {
            glm::vec3 p{0.0f};
            p[axis] = 2.0f * side;
            p[(axis + 1) % 3] = a;
            p[(axis + 2) % 3] = b;
            return p;
          };
          // Inward: on the positive side the winding turns round.
          if (side < 0.0f)
            tiny.quad(at(u, v), at(u + step, v), at(u + step, v + step), at(u, v + step));
          else
            tiny.quad(at(u, v), at(u, v + step), at(u + step, v + step), at(u + step, v));
        }
  return tiny;
}

struct scene_with_rays {
  scene::scene s;
  scene::world_geometry geometry;
  bake::ray_scene rays;
  bake::near_polygons neighbors;
  explicit scene_with_rays(tiny_scene tiny)
      : s(tiny.finished()), geometry(scene::flatten(s)), rays(geometry, false), neighbors(rays) {}
};

const bake::box room_middle{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};

}  // namespace sightcell::test
