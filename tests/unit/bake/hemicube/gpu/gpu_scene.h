#pragma once
// What the tests of the gpu source share: a context, and a scene of many clusters in which most hide behind others.
#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "hemicube/gpu/gpu_source.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_context.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

// A context for all tests of a suite: making one takes longer than a test.
class gpu_test : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    try {
      context_ = std::make_unique<picture::gl_context>(true);
    } catch (const error& e) {
      why_not_ = e.what();
    }
  }
  static void TearDownTestSuite() { context_.reset(); }
  void SetUp() override {
    if (!context_) GTEST_SKIP() << why_not_;
    RecordProperty("renderer", context_->renderer());  // for tests/gl_drivers
  }

  static inline std::unique_ptr<picture::gl_context> context_;
  static inline std::string why_not_;
};

inline void expect_same_view(const bake::hemicube_view& a, const bake::hemicube_view& b, const std::string& what) {
  ASSERT_EQ(a.seen.size(), b.seen.size()) << what;
  for (std::size_t i = 0; i < a.seen.size(); ++i) {
    ASSERT_EQ(a.seen[i].id, b.seen[i].id) << what;
    ASSERT_EQ(a.seen[i].pixels, b.seen[i].pixels) << what;
    ASSERT_EQ(a.seen[i].pixel, b.seen[i].pixel) << what;
  }
  EXPECT_EQ(a.importance, b.importance) << what;
}

// Blocks of small polygons in rooms of a grid, with walls between them that have doors: from a room one sees little.
// Polygons of all kinds; every fiftieth has a twin in the same place, far away in source order or of another kind, so
// that depths are equal.
class rooms {
 public:
  static constexpr int side = 6;       // rooms along x and z
  static constexpr float size = 8.0f;  // meters

  rooms() {
    for (int x = 0; x < side; ++x)
      for (int z = 0; z < side; ++z) furnish(x, z);
    for (int i = 0; i <= side; ++i)
      for (int k = 0; k < side; ++k) {
        wall(i, k, false);
        wall(i, k, true);
      }
    const float end = side * size;
    scene_.quad({0, 0, 0}, {0, 0, end}, {end, 0, end}, {end, 0, 0});
    scene_.quad({0, 3, 0}, {end, 3, 0}, {end, 3, end}, {0, 3, end}, {scene::alpha_mode::opaque, true});
    for (const auto& [corners, how] : twins_) scene_.triangle(corners[0], corners[1], corners[2], how);
  }

  scene::world_geometry world() { return scene::flatten(scene_.finished()); }

  // A walk through the rooms, level and tilted, near and far from the last one; the same for every call.
  static std::vector<bake::pose> walk(std::size_t poses) {
    std::mt19937 engine(3);
    const auto number = [&] { return static_cast<float>(engine() >> 8) / 16777216.0f; };
    std::vector<bake::pose> made;
    for (std::size_t i = 0; i < poses; ++i) {
      bake::pose p;
      p.eye = {side * size * number(), 0.2f + 2.6f * number(), side * size * number()};
      if (i % 3 != 0) p.eye = made.back().eye + glm::vec3(0.3f * number(), 0.0f, 0.3f * number());
      p.forward = glm::normalize(glm::vec3(number() - 0.5f, 0.3f * (number() - 0.5f), number() - 0.5f));
      p.right = glm::normalize(glm::cross(p.forward, glm::vec3(0, 1, 0.1f)));
      p.up = glm::cross(p.right, p.forward);
      made.push_back(p);
    }
    return made;
  }

 private:
  using look = tiny_scene::look;
  float number() { return static_cast<float>(engine_() >> 8) / 16777216.0f; }

  void furnish(int x, int z) {
    const glm::vec3 low(static_cast<float>(x) * size, 0, static_cast<float>(z) * size);
    for (int i = 0; i < 1500; ++i) {
      const glm::vec3 center = low + glm::vec3(size * number(), 2.8f * number(), size * number());
      const auto corner = [&] { return center + 0.3f * (glm::vec3(number(), number(), number()) - glm::vec3(0.5f)); };
      const std::array<glm::vec3, 3> c{corner(), corner(), corner()};
      const look how{i % 9 == 0 ? scene::alpha_mode::blend : scene::alpha_mode::opaque, i % 3 == 0};
      scene_.triangle(c[0], c[1], c[2], how);
      if (i % 50 == 0) twins_.push_back({c, {scene::alpha_mode::opaque, i % 100 == 0}});
      if (i % 500 == 7) {
        const glm::vec3 u = c[1] - c[0], v = c[2] - c[0];
        scene_.masked_quad(c[0], c[0] + u, c[0] + u + v, c[0] + v, {2, 2, {255, 0, 255, 200}}, i % 1000 == 7);
      }
    }
  }

  // Two pieces with a door of a meter between them.
  void wall(int i, int k, bool along_x) {
    const auto at = [&](float along, float y) {
      const float across = static_cast<float>(i) * size, place = static_cast<float>(k) * size + along;
      return along_x ? glm::vec3(place, y, across) : glm::vec3(across, y, place);
    };
    const look both_sides{scene::alpha_mode::opaque, true};
    for (const auto& [from, to] : {std::pair{0.0f, 3.5f}, std::pair{4.5f, size}})
      scene_.quad(at(from, 0), at(to, 0), at(to, 3), at(from, 3), both_sides);
  }

  struct twin {
    std::array<glm::vec3, 3> corners;
    look how;
  };
  tiny_scene scene_;
  std::mt19937 engine_{11};
  std::vector<twin> twins_;
};

}  // namespace sightcell::test
