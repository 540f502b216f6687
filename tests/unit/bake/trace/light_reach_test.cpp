#include "trace/light_reach.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

constexpr float without_limit = std::numeric_limits<float>::infinity();

scene::light lamp_at_origin(float range, float cone) {
  return {.position = {0, 0, 0}, .direction = {0, -1, 0}, .range = range, .cone = cone};
}

TEST(light_reach, of_points) {
  const scene::light bulb = lamp_at_origin(2.0f, 0.0f), spot = lamp_at_origin(without_limit, 0.5f);
  EXPECT_TRUE(is_in_reach(bulb, {0, 1.9f, 0}));
  EXPECT_FALSE(is_in_reach(bulb, {0, 2.1f, 0}));
  EXPECT_TRUE(is_in_reach(spot, {0, -1000, 0}));
  EXPECT_FALSE(is_in_reach(spot, {0, 1, 0}));
  EXPECT_TRUE(is_in_reach(spot, {0.54f, -1, 0})) << "tan(0.5) is 0.546";
  EXPECT_FALSE(is_in_reach(spot, {0.55f, -1, 0}));
}

TEST(light_reach, of_triangles) {
  const triangle near_by{glm::vec3{3, -1, -1}, glm::vec3{3, -1, 1}, glm::vec3{4, -1, 0}};
  EXPECT_FALSE(may_reach(lamp_at_origin(3.1f, 0.0f), near_by, 0.0f));
  EXPECT_TRUE(may_reach(lamp_at_origin(3.1f, 0.0f), near_by, 0.1f)) << "3.162 m away";
  EXPECT_TRUE(may_reach(lamp_at_origin(3.2f, 0.0f), near_by, 0.0f));
  EXPECT_FALSE(may_reach(lamp_at_origin(without_limit, 0.5f), near_by, 0.0f));
  EXPECT_TRUE(may_reach(lamp_at_origin(without_limit, 1.5f), near_by, 0.0f));
}

// A triangle with a point that is lit is never left out.
TEST(light_reach, leaves_out_nothing_that_is_lit) {
  random_stream random(1, 2, purpose::estimate);
  int lit = 0, left_out = 0;
  for (int i = 0; i < 20'000; ++i) {
    const float range = random.uniform() < 0.3f ? without_limit : 1.0f + 9.0f * random.uniform();
    scene::light light = lamp_at_origin(range, random.uniform() < 0.2f ? 0.0f : 0.02f + 1.55f * random.uniform());
    const glm::vec3 axis = random.on_sphere();
    light.direction = {axis.x, axis.y, axis.z};
    const glm::vec3 at = random.in_box(glm::vec3{-8}, glm::vec3{8});
    const float size = 4.0f * random.uniform();
    const triangle t{at + size * random.on_sphere(), at + size * random.on_sphere(), at + size * random.on_sphere()};
    const bool kept = may_reach(light, t, 0.0f);
    left_out += kept ? 0 : 1;
    for (int k = 0; k < 4; ++k) {
      const float a = random.uniform(), b = random.uniform() * (1.0f - a);
      if (!is_in_reach(light, t[0] * a + t[1] * b + t[2] * (1.0f - a - b))) continue;
      ++lit;
      EXPECT_TRUE(kept) << i;
    }
  }
  EXPECT_GT(lit, 5'000);
  EXPECT_GT(left_out, 5'000);
}

}  // namespace
}  // namespace sightcell::bake
