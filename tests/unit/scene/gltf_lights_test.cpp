// Point and spot lights of KHR_lights_punctual.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "loaded_sketch.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;
using point = std::array<float, 3>;

constexpr float no_limit = std::numeric_limits<float>::infinity();

json use_of(const json& number) {
  return {{"KHR_lights_punctual", {{"light", number}}}};
}

// A triangle, and one node with a light of this kind.
gltf_sketch with_light(const json& light) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  g.add_node({{"extensions", use_of(0)}, {"translation", {1, 2, 3}}});
  g.json["extensions"] = {{"KHR_lights_punctual", {{"lights", json::array({light})}}}};
  return g;
}

TEST(gltf_lights, have_what_the_file_states) {
  gltf_sketch g = with_light({{"type", "point"}, {"range", 4.5}});
  json& lights = g.json["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back({{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}});
  lights.push_back({{"type", "directional"}});
  // A quarter turn about x: -z becomes y. Scale changes neither direction nor range.
  const int lamp = g.add_node({{"extensions", use_of(1)},
                               {"translation", {0, 0, 2}},
                               {"rotation", {0.70710678118, 0, 0, 0.70710678118}},
                               {"scale", {3, 3, 3}}});
  g.add_node({{"translation", {10, 0, 0}}, {"children", {lamp}}});
  g.add_node({{"extensions", use_of(2)}});
  const scene s = load(g);
  ASSERT_EQ(s.lights.size(), 2u);
  EXPECT_EQ(s.lights[0].node, 1u);
  EXPECT_EQ(s.lights[0].position, (point{1, 2, 3}));
  EXPECT_EQ(s.lights[0].range, 4.5f);
  EXPECT_EQ(s.lights[0].cone, 0.0f);
  EXPECT_FALSE(s.lights[0].moves);
  EXPECT_EQ(s.lights[1].node, 2u);
  EXPECT_EQ(s.lights[1].position, (point{10, 0, 2}));
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(s.lights[1].direction[axis], (point{0, 1, 0})[axis], 1e-6) << axis;
  EXPECT_EQ(s.lights[1].range, no_limit);
  EXPECT_EQ(s.lights[1].cone, 0.5f);
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_TRUE(s.light_warnings.empty());
}

TEST(gltf_lights, are_not_part_of_the_fingerprint) {
  const gltf_sketch lit = with_light({{"type", "point"}});
  gltf_sketch dark = lit;
  dark.json.erase("extensions");
  EXPECT_EQ(load(lit).fingerprint, load(dark).fingerprint);
  EXPECT_TRUE(load(dark).lights.empty());
  EXPECT_TRUE(load(dark).light_warnings.empty());
}

TEST(gltf_lights, that_move_are_marked) {
  gltf_sketch g = with_light({{"type", "point"}});
  g.json["nodes"][1]["extras"] = {{"sightcell", {{"dynamic", true}}}};
  EXPECT_TRUE(load(g).lights[0].moves);
  g = with_light({{"type", "point"}});
  g.json["animations"] = {{{"channels", {{{"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  EXPECT_TRUE(load(g).lights[0].moves);
  g.json["nodes"][1]["extras"] = {{"sightcell", {{"static", true}}}};
  EXPECT_FALSE(load(g).lights[0].moves);
}

TEST(gltf_lights, wrong_values_are_the_widest) {
  for (const json& range : {json(0), json(-1), json("far"), json(nullptr)}) {
    const scene s = load(with_light({{"type", "point"}, {"range", range}}));
    ASSERT_EQ(s.lights.size(), 1u) << range;
    EXPECT_EQ(s.lights[0].range, no_limit) << range;
    EXPECT_EQ(s.light_warnings.size(), 1u) << range;
  }
  EXPECT_EQ(load(with_light({{"type", "point"}, {"range", 1e300}})).lights[0].range, no_limit);
  for (const json& angle : {json(0), json(-0.5), json(1.7), json("wide")}) {
    const scene s = load(with_light({{"type", "spot"}, {"spot", {{"outerConeAngle", angle}}}}));
    ASSERT_EQ(s.lights.size(), 1u) << angle;
    EXPECT_EQ(s.lights[0].cone, 0.0f) << angle;
    EXPECT_EQ(s.light_warnings.size(), 1u) << angle;
  }
  EXPECT_FLOAT_EQ(load(with_light({{"type", "spot"}})).lights[0].cone, std::numbers::pi_v<float> / 4.0f);
  EXPECT_FLOAT_EQ(load(with_light({{"type", "spot"}, {"spot", {{"outerConeAngle", 1.5708}}}})).lights[0].cone,
                  std::numbers::pi_v<float> / 2.0f);
  gltf_sketch g = with_light({{"type", "spot"}});
  g.json["nodes"][1]["scale"] = {0, 0, 0};
  EXPECT_EQ(load(g).lights[0].cone, 0.0f) << "without a direction it shines everywhere";
}

TEST(gltf_lights, wrong_lights_are_left_out) {
  const auto left_out = [](const gltf_sketch& g) {
    const scene s = load(g);
    EXPECT_TRUE(s.lights.empty());
    EXPECT_TRUE(s.warnings.empty()) << "they decide no visibility";
    return s.light_warnings.size();
  };
  EXPECT_EQ(left_out(with_light({{"type", "area"}})), 1u);
  EXPECT_EQ(left_out(with_light({{"type", 3}})), 1u);
  EXPECT_EQ(left_out(with_light("lamp")), 1u);
  for (const json& number : {json(1), json(-1), json(0.5), json("first"), json(4294967296)}) {
    gltf_sketch g = with_light({{"type", "point"}});
    g.json["nodes"][1]["extensions"] = use_of(number);
    EXPECT_EQ(left_out(g), 1u) << number;
  }
  gltf_sketch g = with_light({{"type", "point"}});
  g.json["nodes"][1]["translation"] = {1e300, 0, 0};
  EXPECT_EQ(left_out(g), 1u);
  g = with_light({{"type", "point"}});
  g.json["extensions"]["KHR_lights_punctual"]["lights"] = 7;
  EXPECT_EQ(left_out(g), 0u);
}

}  // namespace
}  // namespace sightcell::scene
