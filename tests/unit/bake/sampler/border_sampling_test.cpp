#include "sampler/border_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

#include "sightcell/base/random.h"
#include "unit/bake/sampler/geometry_checks.h"

namespace sightcell::bake {
namespace {

using test::ray_meets;

TEST(border_polygon, passes_the_triangle_closely_on_all_sides) {
  random_stream random(1, 1, purpose::verify);
  for (int trial = 0; trial < 200; ++trial) {
    const triangle t{random.in_box({2, -3, -3}, {9, 3, 3}), random.in_box({2, -3, -3}, {9, 3, 3}),
                     random.in_box({2, -3, -3}, {9, 3, 3})};
    const glm::vec3 eye = random.in_box({-1, -1, -1}, {1, 1, 1});
    const float offset = 1e-3f;
    const border_polygon border = enlarged(t, eye, offset);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_FALSE(ray_meets(t, eye, border[i])) << trial << " point " << i;
      double nearest = 1e9;
      for (const glm::vec3& corner : t)
        nearest = std::min(nearest, double(glm::length(border[i] - corner) / glm::length(corner - eye)));
      EXPECT_NEAR(nearest, offset, 1e-5) << "as far from its corner as is said";
    }
    for (std::size_t corner = 0; corner < 3; ++corner)  // three points of each corner, one after the other
      EXPECT_LT(glm::length(border[3 * corner] - border[3 * corner + 2]), 2.1f * offset * 14.0f);
  }
}

TEST(border_polygon, of_a_triangle_under_the_eye_reaches_behind_it) {
  const triangle ground{{{-20, 0, -20}, {20, 0, -20}, {0, 0, 30}}};
  const glm::vec3 eye{0, 1.7f, 0};
  for (const glm::vec3& p : enlarged(ground, eye, 1e-3f)) {
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    EXPECT_FALSE(ray_meets(ground, eye, p) && glm::dot(p - eye, glm::vec3(0, -1, 0)) > 0.0f);
  }
}

TEST(border_polygon, does_not_depend_on_the_corner_that_comes_first) {
  const triangle t{{{3, 0, 0}, {4, 2, 0}, {5, 0, 1}}}, turned{{t[1], t[2], t[0]}};
  EXPECT_EQ(enlarged(t, {0, 0, 0}, 1e-3f), enlarged(turned, {0, 0, 0}, 1e-3f));
}

TEST(sample_border, halves_where_neighbors_met_different_polygons) {
  const triangle t{{{3, 0, 0}, {4, 2, 0}, {5, 0, 1}}};
  const border_polygon border = enlarged(t, {0, 0, 0}, 1e-3f);
  std::vector<glm::vec3> asked;
  const auto same = [&](const glm::vec3& p) {
    asked.push_back(p);
    return border_hit{p, 7, 1.0f};
  };
  sample_border(border, 4, same);
  EXPECT_EQ(asked.size(), 9u);
  // One corner sees something else: on the stretch to each of its neighbors one half goes on differing.
  asked.clear();
  const auto one = [&](const glm::vec3& p) {
    asked.push_back(p);
    return border_hit{p, p == border[4] ? 8u : 7u, 1.0f};
  };
  sample_border(border, 4, one);
  EXPECT_EQ(asked.size(), 9u + 2 * 4u);
  asked.clear();
  std::uint32_t next = 0;
  const auto all = [&](const glm::vec3& p) {
    asked.push_back(p);
    return border_hit{p, next++, 1.0f};
  };
  sample_border(border, 4, all);
  EXPECT_EQ(asked.size(), most_border_rays(4));
}

}  // namespace
}  // namespace sightcell::bake
