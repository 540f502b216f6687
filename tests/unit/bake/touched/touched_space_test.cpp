#include "touched/touched_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
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

// A face of 16 x 8 blocks, the upper half of a cube's side, whose axes are those of a turned pose.
touched_face turned_face(const glm::vec3& eye, random_stream& random) {
  touched_face face;
  face.eye = eye;
  face.forward = glm::normalize(random_in({glm::vec3{-1.0f}, glm::vec3{1.0f}}, random));
  face.right = glm::normalize(glm::cross(face.forward, glm::vec3{0.3f, 0.5f, 0.9f}));
  face.up = glm::cross(face.right, face.forward);
  face.min_x = -1.0f;
  face.step = 0.125f;
  face.reach = 0.064f;
  face.columns = 16;
  face.rows = 8;
  return face;
}

// Returns the depth along forward of the first point of a triangle on a line from the eye; 0 if there is none.
float depth_on_line(const glm::vec3& eye, const glm::vec3& direction, const std::array<glm::vec3, 3>& t) {
  const glm::dvec3 d(direction), a = glm::dvec3(t[0] - eye), b = glm::dvec3(t[1] - eye), c = glm::dvec3(t[2] - eye);
  const double x = glm::dot(d, glm::cross(a, b)), y = glm::dot(d, glm::cross(b, c)), z = glm::dot(d, glm::cross(c, a));
  const double sum = x + y + z;
  if (sum == 0.0 || x / sum < 0.0 || y / sum < 0.0 || z / sum < 0.0) return 0.0f;
  const double depth = glm::dot(a, glm::cross(b, c)) / sum;
  return depth > 1e-4 ? static_cast<float>(depth) : 0.0f;
}

TEST(touched_space, a_triangle_that_a_pixel_of_a_face_sees_is_met) {
  random_stream random(1, 3, purpose::viewpoints);
  int seen = 0, missed = 0;
  for (int i = 0; i < 100; ++i) {
    const touched_face face = turned_face(random_in(small_cell, random), random);
    std::array<float, 128> depths{};
    for (float& depth : depths) depth = std::exp2(6.0f * random.uniform());
    depths[5] = without_end;
    touched_faces faces;
    const auto codes = faces.add(face);
    for (std::size_t k = 0; k < depths.size(); ++k) codes[k] = touched_faces::code_of(1.0f / depths[k]);
    for (int j = 0; j < 200; ++j) {
      const float size = std::exp2(8.0f * random.uniform() - 6.0f);
      const glm::vec3 around = random_in({face.eye - 30.0f, face.eye + 30.0f}, random);
      const auto corners = triangle_around(around, size, random);
      // Lines to three by three points of each block, and to the middle of the triangle.
      const glm::vec3 to = around - face.eye;
      const glm::vec3 at =
          glm::vec3{glm::dot(to, face.right), glm::dot(to, face.up), 0.0f} / glm::dot(to, face.forward);
      const float z = glm::dot(to, face.forward);
      bool sees = false;
      if (z > 1e-4f && at.x > -1.0f && at.x < 1.0f && at.y > 0.0f && at.y < 1.0f)
        sees = z <= depths[static_cast<std::size_t>((at.x + 1.0f) / face.step) +
                           16 * static_cast<std::size_t>(at.y / face.step)];
      for (std::uint32_t k = 0; k < 128 * 9; ++k) {
        const float a = face.min_x + face.step * (static_cast<float>(k / 9 % 16) + static_cast<float>(k % 3) * 0.5f);
        const float b =
            face.min_y + face.step * (static_cast<float>(k / 9 / 16) + static_cast<float>(k / 3 % 3) * 0.5f);
        const float depth = depth_on_line(face.eye, face.forward + a * face.right + b * face.up, corners);
        sees = sees || (depth > 0.0f && depth <= depths[k / 9]);
      }
      const bool met = faces.meets(corners);
      ASSERT_TRUE(met || !sees) << i << ' ' << j;
      const box where{glm::min(corners[0], glm::min(corners[1], corners[2])),
                      glm::max(corners[0], glm::max(corners[1], corners[2]))};
      ASSERT_TRUE(faces.meets(where) || !sees) << i << ' ' << j;
      seen += sees ? 1 : 0;
      missed += met && !sees ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 500);
  EXPECT_LT(2 * missed, seen) << "met, and no line of the test sees it";
}

TEST(touched_space, what_a_face_does_not_see_is_not_met) {
  touched_space space(small_cell, wide_scene);
  touched_face face{{0.0f, 1.0f, 0.0f}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, -1.0f, -1.0f, 0.125f, 0.064f, 16, 16};
  const auto codes = space.mark_face(face);
  std::fill(codes.begin(), codes.end(), touched_faces::code_of(1.0f / 10.0f));
  codes[8 * 16 + 15] = 0;  // to the right: the background
  const auto at = [](float x, float y, float z) {
    return std::array<glm::vec3, 3>{glm::vec3{x, y, z}, glm::vec3{x + 0.1f, y, z}, glm::vec3{x, y + 0.1f, z}};
  };
  EXPECT_TRUE(space.meets(at(0.0f, 1.0f, 9.9f), 0.0f));
  EXPECT_FALSE(space.meets(at(0.0f, 1.0f, 10.8f), 0.0f)) << "behind the wall";
  EXPECT_TRUE(space.meets(at(47.0f, 2.0f, 50.0f), 0.0f)) << "where it sees the background";
  EXPECT_FALSE(space.meets(at(47.0f, 12.0f, 50.0f), 0.0f)) << "beside the background";
  EXPECT_FALSE(space.meets(at(0.0f, 1.0f, -5.0f), 0.0f)) << "behind the eye";
  EXPECT_FALSE(space.meets(at(12.0f, 1.0f, 9.0f), 0.0f)) << "beside the face";
  // A floor below the eye, which reaches behind it, and one whose part in front is behind the wall.
  EXPECT_TRUE(space.meets({glm::vec3{-50, 0, -50}, glm::vec3{50, 0, -50}, glm::vec3{0, 0, 50}}, 0.0f));
  EXPECT_FALSE(space.meets({glm::vec3{-90, -30, -50}, glm::vec3{20, -30, -50}, glm::vec3{-5, -30, 50}}, 0.0f));
  const auto again = touched_space::decode(space.encode());
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->meets(at(0.0f, 1.0f, 9.9f), 0.0f));
  EXPECT_FALSE(again->meets(at(0.0f, 1.0f, 10.8f), 0.0f));
}

TEST(touched_space, bytes_and_damaged_bytes) {
  touched_space space(small_cell, wide_scene);
  space.mark_line({0.0f, 1.0f, 0.0f}, {1.0f, 0.1f, 0.2f}, without_end);
  random_stream random(1, 4, purpose::viewpoints);
  const auto codes = space.mark_face(turned_face({0.0f, 1.0f, 0.0f}, random));
  std::fill(codes.begin(), codes.end(), touched_faces::code_of(0.1f));
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
