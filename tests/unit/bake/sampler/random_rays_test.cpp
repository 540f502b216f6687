#include "sampler/random_rays.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <vector>

#include "trace/ray_scene.h"
#include "unit/bake/sampler/geometry_checks.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::inside;

TEST(random_rays, leave_the_boundary_and_start_inside_where_geometry_is) {
  test::tiny_scene made;
  made.wall_x(50, -1, 5);
  const scene::world_geometry geometry = scene::flatten(made.finished(), scene::animated_as::always);
  const ray_scene rays(geometry, false);
  const box cell{{0, 0, 0}, {4, 2, 4}};
  const std::vector<glm::vec3> free{{2, 1, 2}};
  std::vector<random_ray> drawn;
  for (const bool geometry_inside : {false, true}) {
    const random_rays from(rays, {.seed = 1, .place = 2, .geometry_inside = geometry_inside, .interior_share = 0.25},
                           cell, free);
    std::size_t outward = 0, total = 0;
    std::array<std::size_t, 6> faces{};
    for (std::uint64_t stretch = 0; stretch < 400; ++stretch) {
      from.draw(0, stretch, drawn);
      total += drawn.size();
      for (const random_ray& r : drawn) {
        EXPECT_NEAR(glm::length(r.direction), 1.0f, 1e-5f);
        EXPECT_TRUE(inside(r.eye, cell));
        for (int axis = 0; axis < 3; ++axis)
          for (int side = 0; side < 2; ++side)
            if (r.eye[axis] == (side ? cell.max : cell.min)[axis] && r.direction[axis] * (side ? 1.0f : -1.0f) > 0.0f)
              ++outward, ++faces[static_cast<std::size_t>(2 * axis + side)];
      }
    }
    EXPECT_NEAR(static_cast<double>(outward) / static_cast<double>(total), geometry_inside ? 0.75 : 1.0, 1e-3);
    if (!geometry_inside) {
      EXPECT_NEAR(static_cast<double>(faces[0]) / static_cast<double>(total), 8.0 / 64.0, 0.01) << "by area";
      EXPECT_NEAR(static_cast<double>(faces[2]) / static_cast<double>(total), 16.0 / 64.0, 0.01);
    }
  }
}

}  // namespace
}  // namespace sightcell::bake
