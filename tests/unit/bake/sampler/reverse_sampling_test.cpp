#include "sampler/reverse_sampling.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "unit/bake/sampler/geometry_checks.h"

namespace sightcell::bake {
namespace {

using test::inside;
using test::ray_meets;

TEST(reverse_eyes, look_past_both_sides_of_what_blocked_the_ray) {
  const box cell{{0, 0, 0}, {2, 2, 4}};
  // An upright plate between the cell and what lies beside a polygon behind it.
  const triangle plate{{{6, -10, 1.5f}, {6, 30, 1.5f}, {6, 10, 2.5f}}};
  const glm::vec3 eye{2, 1, 2}, seen{10, 1, 0.5f}, border{10, 1, 2};
  std::vector<glm::vec3> eyes;
  add_reverse_eyes(plate, eye, seen, border, 1e-4f, cell, eyes);
  ASSERT_EQ(eyes.size(), 2u);
  for (const glm::vec3& from : eyes) {
    EXPECT_TRUE(inside(from, cell));
    EXPECT_FLOAT_EQ(from.x, 2.0f) << "where it enters";
    EXPECT_FALSE(ray_meets(plate, from, border));
    EXPECT_TRUE(ray_meets(plate, glm::mix(from, eye, 0.1f), border)) << "closely";
  }
}

TEST(reverse_eyes, of_lines_that_pass_the_cell_by_are_not_valid) {
  const triangle plate{{{6, -10, 1.5f}, {6, 30, 1.5f}, {6, 10, 2.5f}}};
  const glm::vec3 eye{2, 1, 2}, seen{10, 1, 0.5f}, border{10, 1, 2};
  std::vector<glm::vec3> eyes;
  add_reverse_eyes(plate, eye, seen, border, 1e-3f, {{0, 0, 1.9f}, {2, 2, 2.05f}}, eyes);
  EXPECT_TRUE(eyes.empty()) << "the cell is too narrow to look past";
  add_reverse_eyes(plate, eye, eye, border, 1e-3f, {{0, 0, 0}, {2, 2, 4}}, eyes);
  EXPECT_TRUE(eyes.empty()) << "three points on a line span no plane";
}

TEST(reverse_eyes, past_what_stands_in_the_cell_lie_between_it_and_the_far_side) {
  const triangle plate{{{1, -10, 1.5f}, {1, 30, 1.5f}, {1, 10, 2.5f}}};
  const box cell{{0, 0, 0}, {2, 2, 4}};
  std::vector<glm::vec3> eyes;
  add_reverse_eyes(plate, {0, 1, 2}, {10, 1, 0.5f}, {10, 1, 2}, 1e-3f, cell, eyes);
  ASSERT_FALSE(eyes.empty());
  for (const glm::vec3& from : eyes) {
    EXPECT_GT(from.x, 0.0f);
    EXPECT_LT(from.x, 1.0f);
  }
}

TEST(is_blocked_before, takes_what_is_clearly_nearer) {
  EXPECT_TRUE(is_blocked_before(9.8f, 10.0f));
  EXPECT_FALSE(is_blocked_before(9.95f, 10.0f));
  EXPECT_FALSE(is_blocked_before(0.985f, 1.0f));
  EXPECT_FALSE(is_blocked_before(std::numeric_limits<float>::infinity(), 10.0f));
}

}  // namespace
}  // namespace sightcell::bake
