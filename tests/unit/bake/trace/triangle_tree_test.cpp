// A line passes a triangle where a point of it is as close as asked for: compared with the distances of points of it.
#include "trace/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

std::vector<triangle> random_triangles(std::size_t count, random_stream& random) {
  std::vector<triangle> all;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at = random.in_box(glm::vec3(-10.0f), glm::vec3(10.0f));
    const float size = i % 7 == 0 ? 5.0f : 0.5f;
    triangle t;
    for (glm::vec3& corner : t) corner = at + random.in_box(glm::vec3(-size), glm::vec3(size));
    all.push_back(t);
  }
  return all;
}

// Points on the line, closer to each other than a quarter of near.
float least_distance_of_points(const triangle& t, const glm::vec3& start, const glm::vec3& direction, float length,
                               float step) {
  float least = distance_to_triangle(start, t);
  for (float along = 0.0f; along <= length;) {
    const float here = distance_to_triangle(start + along * direction, t);
    least = std::min(least, here);
    along += std::max(step, here - least);
  }
  return least;
}

TEST(triangle_tree, of_nothing) {
  EXPECT_TRUE(triangle_tree().empty());
  EXPECT_FALSE(triangle_tree().passes({0, 0, 0}, {1, 0, 0}));
  EXPECT_FALSE(triangle_tree({}, 1.0f).passes({0, 0, 0}, {1, 0, 0}));
}

TEST(triangle_tree, misses_no_line_that_is_near_enough) {
  constexpr float near = 0.05f, length = 30.0f;
  random_stream random(1, 1, purpose::estimate);
  const std::vector<triangle> all = random_triangles(150, random);
  const triangle_tree tree(all, near);
  std::size_t passing = 0, more = 0;
  for (int i = 0; i < 800; ++i) {
    const glm::vec3 start = random.in_box(glm::vec3(-12.0f), glm::vec3(12.0f));
    const glm::vec3 direction = random.on_sphere();
    const bool is_near = std::any_of(all.begin(), all.end(), [&](const triangle& t) {
      return least_distance_of_points(t, start, direction, length, 0.25f * near) <= near;
    });
    const bool passes = tree.passes(start, direction, length);
    EXPECT_TRUE(passes || !is_near) << "line " << i;
    passing += is_near ? 1 : 0;
    more += passes && !is_near ? 1 : 0;
  }
  EXPECT_GT(passing, 80u);
  EXPECT_LT(passing, 720u);
  EXPECT_LT(more, passing / 10) << "lines at acute corners, and between the points that are looked at";
}

TEST(triangle_tree, of_triangles_without_area) {
  const triangle_tree tree({{{{2, 0, 0}, {2, 0, 0}, {2, 0, 0}}}, {{{4, -1, -1}, {4, 1, 1}, {4, 0, 0}}}}, 0.05f);
  EXPECT_TRUE(tree.passes({0, 0, 0.04f}, {1, 0, 0}, 3.0f));
  EXPECT_FALSE(tree.passes({0, 0, 0.06f}, {1, 0, 0}, 3.0f));
  EXPECT_TRUE(tree.passes({0, 0.9f, 0.92f}, {1, 0, 0}));
  EXPECT_FALSE(tree.passes({0, 1.1f, 0.9f}, {1, 0, 0}));
}

TEST(triangle_tree, looks_as_far_as_the_line_is_long) {
  const triangle_tree wall({{{{2, -1, -1}, {2, 1, -1}, {2, 0, 1}}}}, 0.001f);
  EXPECT_TRUE(wall.passes({0, 0, 0}, {1, 0, 0}));
  EXPECT_TRUE(wall.passes({0, 0, 0}, {1, 0, 0}, 2.0f));
  EXPECT_FALSE(wall.passes({0, 0, 0}, {1, 0, 0}, 1.9f));
  EXPECT_FALSE(wall.passes({0, 0, 0}, {-1, 0, 0}));
  EXPECT_FALSE(wall.passes({0, 0.9f, 0.9f}, {1, 0, 0})) << "in the box of the triangle, beside the triangle";
  EXPECT_FALSE(wall.passes({3, 0, 0}, {1, 0, 0})) << "behind it";
  EXPECT_TRUE(wall.passes({2.0005f, 0, 0}, {1, 0, 0})) << "near enough to it";
}

}  // namespace
}  // namespace sightcell::bake
