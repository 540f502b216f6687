// Paths of cameras that animations move.
#include "sightcell/scene/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

// Adds an animation with one channel.
void move_node(gltf_sketch& g, int node, const std::string& what, const std::vector<float>& times,
               const std::vector<float>& values, const std::string& how = "LINEAR") {
  const int input = g.add_accessor(times, "SCALAR", 5126, times.size());
  const int output =
      what == "rotation" ? g.add_accessor(values, "VEC4", 5126, values.size() / 4) : g.add_positions(values);
  g.json["animations"].push_back({{"samplers", {{{"input", input}, {"output", output}, {"interpolation", how}}}},
                                  {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", what}}}}}}});
}

// Node 0 is a rig, and node 1 the camera below it.
gltf_sketch rig() {
  gltf_sketch g;
  g.json["cameras"] = {{{"name", "Lens"}, {"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  g.add_node({{"name", "rig"}, {"translation", {100, 0, 0}}, {"scale", {2, 2, 2}}, {"children", {1}}});
  g.add_node({{"name", "Camera"}, {"camera", 0}});
  return g;
}

std::vector<point_path> paths_of(const gltf_sketch& g, const std::string& camera = "Camera") {
  const temporary_folder folder;
  return camera_paths(folder.write("rig.glb", g.glb()), camera);
}

std::string path_error(const gltf_sketch& g, const std::string& camera = "Camera") {
  try {
    (void)paths_of(g, camera);
  } catch (const error& e) {
    return e.id();
  }
  return "none";
}

TEST(camera_path, keyframes_are_points_in_the_world) {
  gltf_sketch g = rig();
  move_node(g, 1, "translation", {0, 1, 3}, {0, 0, 0, 1, 0, 0, 1, 0, 5});
  const std::vector<point_path> expected{{{100, 0, 0}, {102, 0, 0}, {102, 0, 10}}};
  EXPECT_EQ(paths_of(g), expected);
  EXPECT_EQ(paths_of(g, "Lens"), expected) << "by the name of the camera";
}

TEST(camera_path, nodes_above_move_a_camera_too) {
  gltf_sketch g = rig();
  g.json["nodes"][1]["translation"] = {1, 0, 0};
  move_node(g, 0, "translation", {0, 1}, {0, 0, 0, 0, 7, 0});
  EXPECT_EQ(paths_of(g), (std::vector<point_path>{{{2, 0, 0}, {2, 7, 0}}}));
}

// A quarter turn of the rig about Y: the camera stays two meters from its axis at each point, not at both ends only.
TEST(camera_path, a_turn_is_an_arc) {
  gltf_sketch g = rig();
  g.json["nodes"][1]["translation"] = {1, 0, 0};
  move_node(g, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, std::sqrt(0.5f), 0, std::sqrt(0.5f)});
  const std::vector<point_path> paths = paths_of(g);
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_EQ(paths[0].size(), 9u);
  for (const auto& p : paths[0]) EXPECT_NEAR(std::hypot(p[0] - 100, p[2]), 2.0, 1e-4);
  EXPECT_NEAR(paths[0].back()[2], -2.0, 1e-4);
  EXPECT_NEAR(paths[0][4][0], 100 + std::sqrt(2.0), 1e-4);
}

TEST(camera_path, a_step_begins_another_path) {
  gltf_sketch g = rig();
  move_node(g, 1, "translation", {0, 1, 2}, {0, 0, 0, 0, 0, 0, 10, 0, 0}, "STEP");
  EXPECT_EQ(paths_of(g), (std::vector<point_path>{{{100, 0, 0}, {100, 0, 0}, {100, 0, 0}}, {{120, 0, 0}}}));
}

// Tangents of 6 and values of 0 at both ends of a second: x is 6 (t - 3 t^2 + 2 t^3), at a quarter 9 / 16.
TEST(camera_path, a_spline_is_sampled) {
  gltf_sketch g = rig();
  move_node(g, 1, "translation", {0, 1}, {0, 0, 0, 0, 0, 0, 6, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0, 0}, "CUBICSPLINE");
  const std::vector<point_path> paths = paths_of(g);
  ASSERT_EQ(paths.size(), 1u);
  ASSERT_EQ(paths[0].size(), 9u);
  EXPECT_NEAR(paths[0][2][0], 100 + 2 * 9.0 / 16, 1e-4);
}

TEST(camera_path, animations_are_paths_of_their_own) {
  gltf_sketch g = rig();
  move_node(g, 1, "translation", {0}, {1, 1, 1});
  move_node(g, 1, "translation", {0}, {2, 2, 2});
  EXPECT_EQ(paths_of(g), (std::vector<point_path>{{{102, 2, 2}}, {{104, 4, 4}}}));
}

TEST(camera_path, what_is_missing_or_broken_is_refused) {
  gltf_sketch g = rig();
  EXPECT_EQ(path_error(g), "scene.camera-at-rest");
  EXPECT_EQ(path_error(g, "camera"), "scene.no-such-camera");
  move_node(g, 1, "rotation", {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0});
  EXPECT_EQ(path_error(g), "scene.camera-at-rest") << "it only turns";
  const auto with = [](const std::vector<float>& times, const std::vector<float>& values) {
    gltf_sketch broken = rig();
    move_node(broken, 1, "translation", times, values);
    return path_error(broken);
  };
  EXPECT_EQ(with({0, 1}, {0, 0, 0}), "scene.bad-field");
  EXPECT_EQ(with({1, 0}, {0, 0, 0, 1, 1, 1}), "scene.bad-field");
  EXPECT_EQ(with({0, NAN}, {0, 0, 0, 1, 1, 1}), "scene.bad-field");
  gltf_sketch cycle = rig();
  cycle.json["nodes"][1]["children"] = {0};
  EXPECT_EQ(path_error(cycle), "scene.node-cycle");
  gltf_sketch outside = rig();
  move_node(outside, 1, "translation", {0}, {1, 1, 1});
  outside.json["animations"][0]["samplers"][0]["output"] = 9;
  EXPECT_EQ(path_error(outside), "scene.index-out-of-range");
}

}  // namespace
}  // namespace sightcell::scene
