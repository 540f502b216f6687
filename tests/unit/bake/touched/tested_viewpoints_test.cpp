#include "touched/tested_viewpoints.h"

#include <gtest/gtest.h>

#include <limits>

#include "trace/ray_scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

TEST(tested_viewpoints, come_back) {
  tested_viewpoints tested;
  tested.add({1, 2, 3}, 1);
  tested.add({0, 0, 0}, 0);
  tested.add({1, 2, 3}, 1);
  const std::vector<std::uint8_t> bytes = tested.encode();
  EXPECT_EQ(bytes.size(), 2 * 13u);
  const edited_boxes edit{{{0, 0, 0}, {1, 1, 1}}, {}};
  tested_viewpoints later;
  EXPECT_FALSE(later.find({1, 2, 3}).has_value());
  later.know(tested_viewpoints::decode(bytes), edit);
  EXPECT_EQ(later.find({1, 2, 3}), 1);
  EXPECT_EQ(later.find({0, 0, 0}), 0);
  EXPECT_FALSE(later.find({-0.0f, 0, 0}).has_value()) << "another point, as far as rays from it are concerned";
  EXPECT_FALSE(later.find({1, 2, 4}).has_value());
  EXPECT_TRUE(later.encode().empty()) << "what it knows is not what it tested";
}

TEST(tested_viewpoints, arbitrary_bytes) {
  const std::vector<std::uint8_t> bytes(100, 0xFF);
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const edited_boxes edit;
    tested_viewpoints known;
    known.know(tested_viewpoints::decode(std::span(bytes).first(size)), edit);
    EXPECT_FALSE(known.find({1, 2, 3}).has_value());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    (void)known.find({nan, nan, nan});
  }
}

// A false result that is known shows which tests are repeated.
TEST(tested_viewpoints, only_tests_that_pass_the_edit_are_repeated) {
  test::tiny_scene tiny;
  tiny.closed_box({-5, -5, -5}, {5, 5, 5}, true);
  const scene::scene s = tiny.finished();
  const scene::world_geometry geometry = scene::flatten(s);
  const ray_scene rays(geometry, false);
  constexpr float radius = 0.2f;
  const glm::vec3 center{0.0f};
  const auto with = [&](const edited_boxes& edit) {
    tested_viewpoints earlier, tested;
    earlier.add(center, 0);
    tested.know(earlier, edit);
    std::uint8_t valid = 0;
    {
      const recording_viewpoints here(&tested);
      rays.find_valid({&center, 1}, radius, {&valid, 1});
    }
    EXPECT_EQ(tested.encode().size(), 13u);
    return valid;
  };
  const box around{{-1, -1, -1}, {1, 1, 1}}, wall{{5, -5, -5}, {5, 5, 5}}, beside{{0.1f, 0.1f, 0.1f}, {0.11f, 0.11f, 0.11f}},
      far{{4, 6, 4}, {4.001f, 6.001f, 4.001f}};
  EXPECT_EQ(with({around, {}}), 1);
  EXPECT_EQ(with({wall, {wall}}), 1);
  EXPECT_EQ(with({beside, {beside}}), 1) << "nearer than the radius";
  EXPECT_EQ(with({far, {}}), 0);
  EXPECT_EQ(with({around, {far}}), 0) << "the parts count";
  EXPECT_EQ(with({around, {far, around}}), 1);
  std::uint8_t valid = 0;
  rays.find_valid({&center, 1}, radius, {&valid, 1});
  EXPECT_EQ(valid, 1) << "nothing is known where nothing is recorded";
}

}  // namespace
}  // namespace sightcell::bake
