#include "walker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "start_view.h"
#include "triangle_tree.h"

namespace viewer {
namespace {

// Triangles of a small place, with the tree over them.
struct ground {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;

  void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c, d});
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + k);
  }
  void level(float y, float x0, float z0, float x1, float z1) {
    quad({x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0});
  }
  triangle_tree tree() const { return {positions, indices}; }
};

// A floor of 20 x 20 m with a wall at x = 5, a step of 0.3 m at z = -5 and a ledge of 1 m at z = 5.
ground place() {
  ground g;
  g.level(0.0f, -10, -10, 10, 10);
  g.quad({5, 0, -10}, {5, 3, -10}, {5, 3, 10}, {5, 0, 10});
  g.level(0.3f, -10, -10, 10, -5);
  g.level(1.0f, -10, 5, 10, 10);
  g.quad({-10, 0, 5}, {10, 0, 5}, {10, 1, 5}, {-10, 1, 5});
  return g;
}

glm::vec3 walk(walker& person, const triangle_tree& scene, glm::vec3 eye, const glm::vec3& velocity, float seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(60.0f * seconds)); ++i) {
    eye = person.move(scene, eye, velocity, false, 1.0f / 60.0f);
  }
  return eye;
}

TEST(walker, falls_to_the_floor_and_walks_on_it) {
  const ground g = place();
  const triangle_tree scene = g.tree();
  walker person;
  glm::vec3 eye = walk(person, scene, {0, 4, 0}, {}, 2.0f);
  EXPECT_NEAR(eye.y, walker::eye_height, 1e-3f);
  EXPECT_TRUE(person.on_floor());
  eye = walk(person, scene, eye, {-2, 5, 0}, 1.0f);  // the height of the velocity does not count
  EXPECT_NEAR(eye.x, -2.0f, 1e-3f);
  EXPECT_NEAR(eye.y, walker::eye_height, 1e-3f);
}

TEST(walker, walls_stop_and_let_slide) {
  const ground g = place();
  const triangle_tree scene = g.tree();
  walker person;
  glm::vec3 eye = walk(person, scene, {0, 1.6f, 0}, {10, 0, 0}, 2.0f);
  EXPECT_NEAR(eye.x, 5.0f - walker::radius, 0.01f);
  eye = walk(person, scene, eye, {10, 0, 1}, 1.0f);
  EXPECT_NEAR(eye.x, 5.0f - walker::radius, 0.01f);
  EXPECT_NEAR(eye.z, 1.0f, 0.05f);
  eye = walk(person, scene, {0, 1.6f, 0}, {400, 0, 0}, 0.5f);  // nor is a wall stepped through in one frame
  EXPECT_NEAR(eye.x, 5.0f - walker::radius, 0.01f);
}

TEST(walker, steps_lift_and_ledges_stop) {
  const ground g = place();
  const triangle_tree scene = g.tree();
  walker person;
  glm::vec3 eye = walk(person, scene, {0, 1.6f, 0}, {0, 0, -4}, 2.0f);
  EXPECT_LT(eye.z, -7.5f);
  EXPECT_NEAR(eye.y, 0.3f + walker::eye_height, 1e-3f);
  eye = walk(person, scene, eye, {0, 0, 4}, 1.5f);
  EXPECT_NEAR(eye.y, walker::eye_height, 1e-3f) << "and down again";
  eye = walk(person, scene, eye, {0, 0, 4}, 4.0f);
  EXPECT_LT(eye.z, 5.0f);
  EXPECT_NEAR(eye.y, walker::eye_height, 1e-3f);
}

TEST(walker, jumps_once_and_keeps_its_height_over_nothing) {
  const ground g = place();
  const triangle_tree scene = g.tree();
  walker person;
  glm::vec3 eye = walk(person, scene, {0, 1.6f, 0}, {}, 0.1f);
  float highest = eye.y;
  for (int i = 0; i < 60; ++i) {
    eye = person.move(scene, eye, {}, i == 0, 1.0f / 60.0f);
    highest = std::max(highest, eye.y);
  }
  EXPECT_GT(highest, walker::eye_height + 0.6f);
  EXPECT_NEAR(eye.y, walker::eye_height, 1e-3f);
  EXPECT_EQ(walk(person, scene, {50, 7, 0}, {}, 1.0f), glm::vec3(50, 7, 0));
}

TEST(triangle_tree, rays_and_spheres_find_what_a_search_of_all_triangles_finds) {
  ground g;
  unsigned state = 1;
  const auto random = [&] { return static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0f; };
  const auto point = [&] { return 10.0f * glm::vec3(random(), random(), random()); };
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 a = point();
    g.quad(a, a + 0.1f * point(), a + 0.1f * point(), a);  // the second triangle has no area
  }
  const triangle_tree scene = g.tree();
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 from = point(), direction = glm::normalize(point() - from);
    std::optional<float> nearest;
    for (std::size_t t = 0; t < g.indices.size(); t += 3) {
      ground one;
      one.positions = {g.positions[g.indices[t]], g.positions[g.indices[t + 1]], g.positions[g.indices[t + 2]]};
      one.indices = {0, 1, 2};
      const triangle_tree alone(one.positions, one.indices);
      const auto distance = alone.cast(from, direction, 100.0f);
      if (distance && (!nearest || *distance < *nearest)) nearest = distance;
    }
    const auto found = scene.cast(from, direction, 100.0f);
    ASSERT_EQ(found.has_value(), nearest.has_value());
    if (!found) continue;
    ++hits;
    EXPECT_EQ(*found, *nearest);
    const glm::vec3 before = from + (*found - 0.01f) * direction;
    const auto touched = scene.nearest(before, 0.02f);
    ASSERT_TRUE(touched.has_value());
    EXPECT_LE(glm::distance(*touched, before), 0.0101f);
  }
  EXPECT_GT(hits, 20);
  const triangle_tree nothing({}, {});
  EXPECT_FALSE(nothing.cast({}, {1, 0, 0}, 10.0f).has_value());
  EXPECT_FALSE(nothing.nearest({}, 10.0f).has_value());
}

TEST(start_view, looks_along_the_longest_line_that_ends) {
  ground g;
  g.quad({-1, 0, -30}, {1, 0, -30}, {1, 3, -30}, {-1, 3, -30});  // 30 m before the first eye
  g.quad({-1, 0, 4}, {1, 0, 4}, {1, 3, 4}, {-1, 3, 4});
  const triangle_tree scene = g.tree();
  const std::vector<glm::vec3> eyes{{0, 1, -25}, {0, 1, 0}};
  const fly_camera camera = best_view(scene, eyes);
  EXPECT_EQ(camera.eye, eyes[1]);
  EXPECT_NEAR(camera.yaw, 0.0f, 0.01f);
  EXPECT_EQ(nearest_eye(eyes, {0, 0, -3}), 1u);
  const fly_camera lost = best_view(triangle_tree({}, {}), eyes);
  EXPECT_EQ(lost.eye, eyes[0]);
}

}  // namespace
}  // namespace viewer
