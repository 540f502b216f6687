#include "touched/touched_space.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <limits>

#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

constexpr float without_end = std::numeric_limits<float>::infinity();
const box small_cell{{-2.0f, 0.0f, -2.0f}, {2.0f, 2.0f, 2.0f}},
    wide_scene{{-100.0f, -5.0f, -80.0f}, {60.0f, 40.0f, 90.0f}};

glm::vec3 random_in(const box& where, random_stream& random) {
  return random.in_box(where.min, where.max);
}

std::array<glm::vec3, 3> triangle_around(const glm::vec3& point, float size, random_stream& random) {
  const box near{glm::vec3{-size}, glm::vec3{size}};
  const glm::vec3 a = random_in(near, random), b = random_in(near, random);
  return {point + a, point + b, point - a - b};  // its centroid is the point
}

TEST(touched_space, a_triangle_on_a_line_is_met) {
  random_stream random(1, 2, purpose::viewpoints);
  for (int i = 0; i < 2000; ++i) {
    touched_space space(small_cell, wide_scene);
    const glm::vec3 eye = random_in(small_cell, random), end = random_in(wide_scene, random);
    space.mark_line(eye, end - eye, 1.0f);
    const glm::vec3 on_line = eye + (end - eye) * random.uniform();
    for (const float size : {0.001f, 0.3f, 20.0f}) {
      const auto corners = triangle_around(on_line, size, random);
      ASSERT_TRUE(space.meets(corners, 1e-4f)) << i;
    }
  }
}

TEST(touched_space, what_is_far_from_a_line_is_not_met) {
  touched_space space(small_cell, wide_scene);
  space.mark_line({0.0f, 1.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, 40.0f);
  const auto at = [](float x, float y, float z) {
    return std::array<glm::vec3, 3>{glm::vec3{x, y, z}, glm::vec3{x + 0.1f, y, z}, glm::vec3{x, y + 0.1f, z}};
  };
  EXPECT_TRUE(space.meets(at(30.0f, 1.0f, 0.0f), 0.0f));
  EXPECT_FALSE(space.meets(at(30.0f, 20.0f, 0.0f), 0.0f)) << "above";
  EXPECT_FALSE(space.meets(at(55.0f, 1.0f, 0.0f), 0.0f)) << "behind its end";
  EXPECT_FALSE(space.meets(at(-30.0f, 1.0f, 0.0f), 0.0f)) << "on the other side";
  EXPECT_FALSE(space.meets(at(0.5f, 1.9f, 1.9f), 0.0f)) << "near the cell, voxels are small";
  EXPECT_FALSE(space.meets(at(500.0f, 0.0f, 0.0f), 0.0f)) << "beyond the scene, where no line went";
  // Its box meets the line, and its plane does not.
  EXPECT_FALSE(
      space.meets(std::array<glm::vec3, 3>{glm::vec3{10, 1, 20}, glm::vec3{30, 1, 40}, glm::vec3{10, 30, -10}}, 0.0f));
}

TEST(touched_space, what_is_beyond_the_scene_is_met_by_lines_that_leave_it) {
  touched_space space(small_cell, wide_scene);
  space.mark_line({0.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, without_end);
  EXPECT_TRUE(space.meets(box{{500.0f, 0.0f, 0.0f}, {501.0f, 1.0f, 1.0f}}, 0.0f));
  EXPECT_TRUE(space.meets(box{{-0.1f, 30.0f, -0.1f}, {0.1f, 31.0f, 0.1f}}, 0.0f));
  EXPECT_FALSE(space.meets(box{{20.0f, 30.0f, 0.0f}, {20.5f, 31.0f, 0.5f}}, 0.0f));
}

TEST(touched_space, a_box_is_met) {
  touched_space space(small_cell, wide_scene);
  space.mark_box(small_cell.min, small_cell.max);
  EXPECT_TRUE(space.meets(box{{1.9f, 1.9f, 1.9f}, {3.0f, 3.0f, 3.0f}}, 0.0f));
  EXPECT_FALSE(space.meets(box{{10.0f, 1.9f, 1.9f}, {11.0f, 3.0f, 3.0f}}, 0.0f));
}

TEST(touched_space, bytes_and_damaged_bytes) {
  touched_space space(small_cell, wide_scene);
  space.mark_line({0.0f, 1.0f, 0.0f}, {1.0f, 0.1f, 0.2f}, without_end);
  const std::vector<std::uint8_t> bytes = space.encode();
  const auto again = touched_space::decode(bytes);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->encode(), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(touched_space::decode(std::span(bytes).first(size))) << size;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const std::uint8_t value : std::array<std::uint8_t, 3>{0x00, 0x7F, 0xFF}) {
      std::vector<std::uint8_t> damaged = bytes;
      damaged[i] = value;
      const auto decoded = touched_space::decode(damaged);
      if (decoded) (void)decoded->meets(wide_scene, 0.1f);
    }
}

}  // namespace
}  // namespace sightcell::bake
