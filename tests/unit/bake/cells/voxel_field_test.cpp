#include "cells/voxel_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace sightcell::bake {
namespace {

field_shape shape_of_field() {
  field_shape shape;
  shape.world = {{-8.0, -1.0, -16.0}, {8.0, 5.0, 16.0}};
  shape.voxel = 0.25;
  shape.width = 64;
  shape.depth = 128;
  return shape;
}

// Triangles of all sizes, some of them in the planes between rows of voxels, some beyond the field.
scene::world_geometry random_triangles(unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() % 65536) / 65535.0f;
  };
  scene::world_geometry g;
  for (int i = 0; i < 600; ++i) {
    const float size = i % 10 == 0 ? 40.0f : 1.5f;
    const glm::vec3 at{number(-9, 9), number(0, 4), number(-18, 18)};
    const float plane = 0.25f * std::round(at.z / 0.25f);
    for (int k = 0; k < 3; ++k) {
      glm::vec3 corner = at + glm::vec3{number(-size, size), number(-1, 1), number(-size, size)};
      if (i % 7 == 0) corner.z = plane;
      g.positions.push_back(corner);
      g.indices.push_back(static_cast<std::uint32_t>(g.indices.size()));
    }
    g.kinds.emplace_back().double_sided = true;
  }
  return g;
}

open_field spaces_with(const scene::world_geometry& g, int threads) {
  return open_spaces(g, shape_of_field(), {.height = 18, .step = 4, .jump = 10, .gap = 3}, settings(), threads);
}

TEST(voxel_field, strips_do_not_change_spaces) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const scene::world_geometry g = random_triangles(seed);
    const open_field one = spaces_with(g, 0);
    ASSERT_GT(one.spaces.size(), 8192u);
    std::size_t floors = 0;
    for (const open_space& space : one.spaces) floors += space.walkable ? 1 : 0;
    EXPECT_GT(floors, 1000u);
    for (const int threads : {1, 2, 16}) {
      const open_field other = spaces_with(g, threads);
      EXPECT_EQ(other.begins, one.begins) << seed;
      EXPECT_EQ(other.spaces, one.spaces) << seed;
    }
  }
}

}  // namespace
}  // namespace sightcell::bake
