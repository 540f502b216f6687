// Parts of masked polygons: they cover all that may pass the alpha test, and little else.
#include "trace/masked_parts.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "sightcell/scene/alpha_mask.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

// Leaves: disks of one texel in four, on transparent ground.
scene::alpha_mask leaves(std::uint32_t size) {
  scene::alpha_mask mask{size, size, {}, 0.5f};
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const int dx = static_cast<int>(x % 32) - 16, dy = static_cast<int>(y % 32) - 16;
      mask.texels.push_back(dx * dx + dy * dy < 80 ? 255 : 0);
    }
  return mask;
}

// Polygons with random parts of the mask, some of which pass nowhere.
std::vector<scene::masked_polygon> random_polygons(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<scene::masked_polygon> polygons(count);
  for (scene::masked_polygon& p : polygons) {
    const float size = unit(random) * unit(random);
    const glm::vec2 from{unit(random), unit(random)};
    for (glm::vec2& uv : p.uvs) {
      const float across = unit(random);
      uv = from + size * glm::vec2{across, unit(random)};
    }
  }
  return polygons;
}

bool contains(const masked_part& part, float u, float v) {
  const float a = (u - part.u) / part.size, b = (v - part.v) / part.size;
  return a >= 0.0f && b >= 0.0f && a + b <= 1.0f;
}

bool passes(const scene::masked_polygon& p, const scene::alpha_mask& mask, float u, float v) {
  return mask.passes(p.uvs[0] + (p.uvs[1] - p.uvs[0]) * u + (p.uvs[2] - p.uvs[0]) * v, 1.0f);
}

TEST(masked_parts, cover_what_may_pass_once) {
  const std::vector<scene::alpha_mask> masks{leaves(128)};
  const std::vector<scene::masked_polygon> polygons = random_polygons(200);
  const scene::opacity_maps maps = scene::make_opacity_maps(polygons, masks);
  const masked_parts parts(maps);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::size_t empty = 0, divided = 0;
  double area = 0.0, passing = 0.0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const auto of_polygon = parts.of(i);
    ASSERT_LE(of_polygon.size(), 16u);
    empty += of_polygon.empty() ? 1 : 0;
    divided += of_polygon.size() > 1 ? 1 : 0;
    for (const masked_part& part : of_polygon) area += static_cast<double>(part.size) * static_cast<double>(part.size);
    for (int k = 0; k < 1'000; ++k) {
      float u = unit(random), v = unit(random);
      if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
      std::size_t in = 0;
      for (const masked_part& part : of_polygon) in += contains(part, u, v) ? 1 : 0;
      ASSERT_LE(in, 1u) << "polygon " << i << " at " << u << ", " << v;
      if (!passes(polygons[i], masks[0], u, v)) continue;
      passing += 1e-3;
      ASSERT_EQ(in, 1u) << "polygon " << i << " passes at " << u << ", " << v;
    }
  }
  EXPECT_GT(empty, 10u);
  EXPECT_GT(divided, 50u);
  EXPECT_LT(area, 0.75 * 200.0);
  EXPECT_GT(area, passing);
}

TEST(masked_parts, a_polygon_without_a_map_is_one) {
  const scene::opacity_maps none;
  ASSERT_EQ(masked_parts(none).of(7).size(), 1u);
  const masked_part whole = masked_parts(none).of(7)[0];
  EXPECT_EQ(whole.u, 0.0f);
  EXPECT_EQ(whole.v, 0.0f);
  EXPECT_EQ(whole.size, 1.0f);
}

TEST(masked_parts, two_polygons_with_an_edge_have_the_same_corners_on_it) {
  const glm::vec3 a{0.1f, 100.3f, -7.7f}, b{33.3f, 0.7f, 1e-3f}, c{-5.1f, 2.2f, 9.9f}, d{64.1f, -3.3f, 5.7f};
  const triangle one{a, b, c}, other{d, b, a};  // the edge is u of the first; of the second it is opposite to corner 0
  for (const float along : {0.25f, 0.5f, 0.75f}) {
    const glm::vec3 here = corners_of_part(one, {along, 0.0f, 0.25f})[0],
                    there = corners_of_part(other, {along, 1.0f - along, 0.0f})[0];
    EXPECT_EQ(here, there) << along;
  }
}

TEST(masked_parts, a_ray_sees_through_what_is_left_out_and_a_camera_keeps_off_it) {
  scene::alpha_map corner{32, 32, {}};  // passes near one corner only
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) corner.texels.push_back(x < 6 && y < 6 ? 255 : 0);
  test::tiny_scene tiny;
  const auto leaf = tiny.masked_quad({4, -2, -2}, {4, -2, 2}, {4, 2, 2}, {4, 2, -2}, corner, true);
  const auto wall = tiny.wall_x(8, -1, 4);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  std::size_t on_leaf = 0, on_wall = 0;
  sight seen;
  for (float y = -1.9f; y < 2.0f; y += 0.1f)
    for (float z = -1.9f; z < 2.0f; z += 0.1f) {
      rays.trace({0, y, z}, {1, 0, 0}, seen);
      on_leaf += seen.front == leaf || seen.front == leaf + 1 ? 1 : 0;
      on_wall += seen.front == wall || seen.front == wall + 1 ? 1 : 0;
    }
  EXPECT_GT(on_leaf, 20u);
  EXPECT_LT(on_leaf, 100u);
  EXPECT_EQ(on_leaf + on_wall, 1521u);
  for (const float y : {-1.5f, 0.2f, 1.5f})
    for (const float z : {-1.5f, 0.1f, 1.5f}) {
      EXPECT_FALSE(rays.is_valid({3.97f, y, z}, 0.05f)) << y << ", " << z;
      EXPECT_TRUE(rays.is_valid({3.9f, y, z}, 0.05f)) << y << ", " << z;
    }
  EXPECT_EQ(rays.touching({3.9f, 1.0f, -1.2f}, {4.1f, 1.2f, -1.0f}).size(), 1u) << "each once";
}

TEST(masked_parts, all_of_a_leaf_hides_the_backs_of_a_solid) {
  scene::alpha_map clear{32, 32, std::vector<std::uint8_t>(32 * 32, 0)};
  clear.texels[0] = 255;
  test::tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9});
  const auto side = [&](const glm::vec3& middle, const glm::vec3& right, const glm::vec3& up) {
    tiny.masked_quad(middle - right - up, middle + right - up, middle + right + up, middle - right + up, clear, true);
  };
  for (const float at : {-1.0f, 1.0f}) {
    side({at, 0, 0}, {0, 1, 0}, {0, 0, 1});
    side({0, at, 0}, {1, 0, 0}, {0, 0, 1});
    side({0, 0, at}, {1, 0, 0}, {0, 1, 0});
  }
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  EXPECT_FALSE(rays.is_valid({5, 0, 0}, 0.05f));
  EXPECT_TRUE(rays.is_valid({0.3f, 0.2f, 0.1f}, 0.05f));
}

}  // namespace
}  // namespace sightcell::bake
