#include <gtest/gtest.h>

#include <cstdint>
#include <glm/geometric.hpp>
#include <random>

#include "trace/ray_scene.h"
#include "unit/bake/hemicube/all_sources.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using namespace sightcell::test;
using look = tiny_scene::look;

class source_mask_test : public source_test {};

const look pane{scene::alpha_mode::blend, false};

// Seen from the origin along +x: faces -x, u runs along +z (to the right) from -half to half, v upward.
std::uint32_t masked_wall_x(tiny_scene& s, float place, float half, scene::alpha_map map, bool double_sided = false) {
  return s.masked_quad({place, -half, -half}, {place, -half, half}, {place, half, half}, {place, half, -half},
                       std::move(map), double_sided);
}

TEST_P(source_mask_test, a_mask_is_seen_and_hides_where_its_alpha_passes) {
  tiny_scene s;
  const auto wall = s.wall_x(4, -1, 2);
  const auto leaf = masked_wall_x(s, 2, 1, {2, 1, {255, 0}});
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, leaf));
  EXPECT_TRUE(sees_wall(view, wall));
  EXPECT_EQ(pixels_of(view, leaf) + pixels_of(view, leaf + 1), 16u * 32u) << "its left half";
  EXPECT_EQ(pixels_of(view, wall) + pixels_of(view, wall + 1), 16u * 32u) << "what the other half lets through";
}

TEST_P(source_mask_test, a_mask_that_passes_nowhere_or_everywhere) {
  tiny_scene s;
  const auto wall = s.wall_x(5, -1, 1);
  const auto gone = masked_wall_x(s, 2, 1, {2, 2, {127, 127, 127, 127}});
  EXPECT_FALSE(sees_wall(look_at(s), gone));
  EXPECT_TRUE(sees_wall(look_at(s), wall));
  const auto closed = masked_wall_x(s, 3, 1, {2, 2, {128, 128, 255, 255}});
  EXPECT_TRUE(sees_wall(look_at(s), closed));
  EXPECT_FALSE(sees_wall(look_at(s), wall));
}

TEST_P(source_mask_test, masks_know_sides_and_panes_behind_their_holes) {
  tiny_scene s;
  const auto turned = s.masked_quad({2, -1, 1}, {2, -1, -1}, {2, 1, -1}, {2, 1, 1}, {2, 1, {255, 0}});
  const auto leaf = masked_wall_x(s, 3, 1, {2, 1, {255, 0}}, true);
  const auto glass = s.quad({4, -1, -1.2f}, {4, -1, -0.2f}, {4, 1, -0.2f}, {4, 1, -1.2f}, pane);
  const auto seen_glass = s.quad({4, -1, 0.2f}, {4, -1, 1}, {4, 1, 1}, {4, 1, 0.2f}, pane);
  const auto view = look_at(s);
  EXPECT_FALSE(sees(view, turned)) << "from behind";
  EXPECT_TRUE(sees_wall(view, leaf));
  EXPECT_FALSE(sees(view, glass)) << "behind the half that is there";
  EXPECT_TRUE(sees_wall(view, seen_glass)) << "behind the hole";
}

// Leaves of random alpha in perspective, turned, mirrored and crossing each other: as many pixels of each polygon as
// rays see.
TEST_P(source_mask_test, masks_agree_with_rays) {
  std::mt19937 random(7);
  const auto noise = [&](std::uint32_t width, std::uint32_t height) {
    scene::alpha_map map{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) map.texels.push_back(static_cast<std::uint8_t>(random() % 256));
    return map;
  };
  tiny_scene s;
  s.wall_x(9, -1, 20);
  s.masked_quad({2, -3, -1}, {7, -3, 4}, {7, 3, 4}, {2, 3, -1}, noise(7, 5), true);
  s.masked_quad({6, -4, -9}, {3, -4, 3}, {3, 2, 3}, {6, 2, -9}, noise(13, 1), true);
  s.masked_quad({1, -1, -4}, {8, -1, -4}, {8, -1, 4}, {1, -1, 4}, noise(8, 8), true);
  scene::scene finished = s.finished();
  finished.geometries[2].uvs = {{-3.5f, 2}, {4, 2}, {4, -1}, {-3.5f, -1}};  // repeats, and runs backwards
  finished.draws[3].to_world[2][2] = -1.0;
  finished.geometries[1].uvs = {{-0.4f, -0.2f}, {1.7f, -0.2f}, {1.7f, 1.5f}, {-0.4f, 1.5f}};
  finished.materials[1].wrap_u = scene::wrap::mirror;
  finished.materials[1].wrap_v = scene::wrap::clamp;
  finished.geometries[3].colors = {glm::u8vec4(255), {0, 0, 0, 200}, {0, 0, 0, 90}, glm::u8vec4(255)};
  const scene::world_geometry world = scene::flatten(finished);
  ASSERT_EQ(world.masked.size(), 6u);
  const bake::pose turned = turned_along_x();
  bake::hemicube_view view;
  source(world, 256)->render(turned, view);
  const bake::ray_scene rays(world, false);
  std::vector<std::uint32_t> expected(world.kinds.size(), 0);
  bake::sight seen;
  // Front image: -1..1 in both directions; the half images to the right, left, above and below.
  const auto count = [&](float forward, float up, float right) {
    rays.trace({0, 0, 0}, glm::normalize(forward * turned.forward + up * turned.up + right * turned.right), seen);
    if (seen.front != bake::no_polygon) ++expected[seen.front];
  };
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float a = (static_cast<float>(x) + 0.5f) / 128.0f - 1.0f,
                  b = (static_cast<float>(y) + 0.5f) / 128.0f - 1.0f;
      count(1, b, a);
      if (a < 0.0f) continue;  // how far forward: half faces
      count(a, b, 1);
      count(a, b, -1);
      count(a, 1, b);
      count(a, -1, b);
    }
  }
  for (std::uint32_t id = 0; id < expected.size(); ++id)
    EXPECT_NEAR(pixels_of(view, id), expected[id], 4 + expected[id] / 1000) << id;
}

SIGHTCELL_TEST_ALL_SOURCES(source_mask_test);

}  // namespace
