// Morph targets and skins at rest: where the vertices stand, and what files may not say about it.
#include <gtest/gtest.h>

#include <functional>
#include <glm/geometric.hpp>

#include "loaded_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;
using points = std::vector<glm::vec3>;

void expect_near(const points& got, const points& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_LT(glm::distance(got[i], expected[i]), 1e-5f) << i << ": " << got[i].x << ' ' << got[i].y << ' ' << got[i].z;
}

points world(const scene& s) {
  return flatten(s).positions;
}

json& primitive_of(gltf_sketch& g) {
  return g.json["meshes"][0]["primitives"][0];
}

// A triangle (0,0,0) (1,0,0) (0,1,0) with two targets: up by 2 at the last corner, and all toward +z by 1.
gltf_sketch morphing() {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  const int up = g.add_positions({0, 0, 0, 0, 0, 0, 0, 2, 0}), out = g.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  primitive_of(g)["targets"] = {{{"POSITION", up}}, {{"POSITION", out}}};
  return g;
}

const points unmoved = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(morph_targets, rest_without_weights_and_are_then_not_read) {
  gltf_sketch g = morphing();
  EXPECT_EQ(world(load(g)), unmoved);
  g.json["meshes"][0]["weights"] = {0, 0};
  g.json["accessors"][1]["bufferView"] = 99;
  EXPECT_EQ(world(load(g)), unmoved);
  EXPECT_FALSE(load(g).draws[0].tags.animated) << "nothing moves";
  g.json["meshes"][0]["weights"] = {0, 1};
  expect_near(world(load(g)), {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
  g.json["meshes"][0]["weights"] = {0.5, 0};
  EXPECT_EQ(refusal(g), "scene.index-out-of-range");
}

TEST(morph_targets, take_the_weights_of_the_mesh_and_those_of_the_node_over_them) {
  gltf_sketch g = morphing();
  g.json["meshes"][0]["weights"] = {0.5, 1};
  expect_near(world(load(g)), {{0, 0, 1}, {1, 0, 1}, {0, 2, 1}});
  g.json["nodes"][0]["weights"] = {0, 0.25};
  expect_near(world(load(g)), {{0, 0, 0.25f}, {1, 0, 0.25f}, {0, 1, 0.25f}});
  g.json["nodes"][0]["weights"] = {0, 0};
  EXPECT_EQ(world(load(g)), unmoved);
  g.json["nodes"][0]["weights"] = {-1};  // fewer weights than targets, and the other way round
  expect_near(world(load(g)), {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}});
  g.json["nodes"][0]["weights"] = {0, 0, 7};
  EXPECT_EQ(world(load(g)), unmoved);
}

TEST(morph_targets, move_with_their_node) {
  gltf_sketch g = morphing();
  g.json["nodes"][0]["weights"] = {0, 1};
  g.json["nodes"][0]["scale"] = {1, 1, 3};
  expect_near(world(load(g)), {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}});
}

TEST(morph_targets, may_be_sparse_or_quantized) {
  gltf_sketch g = morphing();
  g.json["meshes"][0]["weights"] = {1, 1};
  // Only the middle corner of the first target; the second in sixteenths of a unit.
  const int at = g.add_accessor(std::vector<std::uint16_t>{1}, "SCALAR", 5123, 1);
  const int by = g.add_accessor(std::vector<float>{0, 0, 5}, "VEC3", 5126, 1);
  g.json["accessors"][1].erase("bufferView");
  g.json["accessors"][1]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", 5123}}}, {"values", {{"bufferView", by}}}};
  const std::vector<std::int16_t> bits = {32767, 0, 0, 0, 0, -32767, 0, 0, 0, 0, 0, 0};
  const int quantized = g.add_accessor(bits, "VEC3", 5122, 3);
  g.json["bufferViews"].back()["byteStride"] = 8;
  g.json["accessors"].back()["normalized"] = true;
  primitive_of(g)["targets"][1]["POSITION"] = quantized;
  expect_near(world(load(g)), {{1, 0, 0}, {1, -1, 5}, {0, 1, 0}});
}

TEST(morph_targets, change_neither_source_ids_nor_counts_and_equal_poses_share_their_geometry) {
  gltf_sketch g = morphing();
  for (int i = 0; i < 4; ++i) g.add_node({{"mesh", 0}});
  g.json["nodes"][1]["weights"] = {1, 0};
  g.json["nodes"][3]["weights"] = {0, 1};
  g.json["nodes"][4]["weights"] = {1, 0};
  const scene s = load(g);
  EXPECT_EQ(s.polygon_count, 5u);
  ASSERT_EQ(s.draws.size(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(s.draws[i].first_source, i);
    EXPECT_EQ(s.draws[i].node, i);
  }
  EXPECT_EQ(s.geometries.size(), 3u);
  EXPECT_EQ(s.draws[0].geometry, s.draws[2].geometry);
  EXPECT_EQ(s.draws[1].geometry, s.draws[4].geometry);
  EXPECT_NE(s.draws[1].geometry, s.draws[3].geometry);
}

TEST(morph_targets, that_are_broken_are_refused) {
  const auto after = [](const std::function<void(gltf_sketch&)>& change) {
    gltf_sketch g = morphing();
    g.json["meshes"][0]["weights"] = {1, 1};
    change(g);
    return refusal(g);
  };
  EXPECT_EQ(after([](gltf_sketch&) {}), "none");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["meshes"][0]["weights"] = {1, "all"}; }), "scene.bad-field");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["nodes"][0]["weights"] = 1; }), "scene.bad-field");
  EXPECT_EQ(after([](gltf_sketch& g) { primitive_of(g)["targets"] = {3}; }), "scene.bad-field");
  EXPECT_EQ(after([](gltf_sketch& g) { primitive_of(g)["targets"][0]["POSITION"] = 9; }), "scene.index-out-of-range");
  EXPECT_EQ(after([](gltf_sketch& g) { primitive_of(g)["targets"][0].erase("POSITION"); }), "none") << "normals alone";
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][1]["count"] = 2; }), "scene.bad-field");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][1]["count"] = 4; }), "scene.accessor-bounds");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][1]["type"] = "VEC2"; }), "scene.accessor-type");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][1]["componentType"] = 5125; }), "scene.accessor-type");
}

// A small file may name one accessor as a target very many times.
TEST(morph_targets, in_absurd_numbers_are_refused) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(20'000))}});
  for (int i = 0; i < 20'000; ++i) {
    primitive_of(g)["targets"].push_back({{"POSITION", 0}});
    g.json["meshes"][0]["weights"].push_back(1);
  }
  EXPECT_EQ(refusal(g), "scene.too-large");
}

// A triangle whose corners hang on joint 0, on joint 1, and on both half and half. Node 0 has the mesh; node 1 is joint
// 0 at rest, node 2 below it is joint 1, one unit up and turned a quarter around z (x becomes y).
gltf_sketch skinned() {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}, {"skin", 0}});
  g.add_node({{"children", {2}}});
  g.add_node({{"translation", {0, 1, 0}}, {"rotation", {0, 0, 0.7071067811865476, 0.7071067811865476}}});
  const std::vector<std::uint8_t> joints = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
  const std::vector<float> weights = {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0};
  primitive_of(g)["attributes"]["JOINTS_0"] = g.add_accessor(joints, "VEC4", 5121, 3);
  primitive_of(g)["attributes"]["WEIGHTS_0"] = g.add_accessor(weights, "VEC4", 5126, 3);
  g.json["skins"] = {{{"joints", {1, 2}}}};
  return g;
}

// (1,0,0) becomes (0,1,0) + (0,1,0); (0,1,0) the middle of itself and (-1,0,0) + (0,1,0).
const points bent = {{0, 0, 0}, {0, 2, 0}, {-0.5f, 1, 0}};

TEST(skins, bend_the_mesh_to_the_pose_of_their_joints) {
  const scene s = load(skinned());
  expect_near(world(s), bent);
  EXPECT_TRUE(s.draws[0].tags.animated);
  EXPECT_EQ(s.warnings.size(), 1u);
}

TEST(skins, ignore_where_the_node_of_the_mesh_stands) {
  gltf_sketch g = skinned();
  g.json["nodes"][0]["translation"] = {100, 0, 0};
  expect_near(world(load(g)), bent);
  g.json["nodes"][0].erase("skin");  // and without the skin nothing else counts
  expect_near(world(load(g)), {{100, 0, 0}, {101, 0, 0}, {100, 1, 0}});
  EXPECT_FALSE(load(g).draws[0].tags.animated);
}

TEST(skins, stand_where_what_is_above_their_joints_puts_them) {
  gltf_sketch g = skinned();
  g.add_node({{"translation", {0, 0, 7}}, {"children", {1}}});
  g.json["scenes"] = {{{"nodes", {0}}}};  // the joints are not in the scene
  expect_near(world(load(g)), {{0, 0, 7}, {0, 2, 7}, {-0.5f, 1, 7}});
}

TEST(skins, have_inverse_bind_matrices) {
  gltf_sketch g = skinned();
  // Joint 1 was bound one unit up: it turns around (0, 1, 0).
  const std::vector<float> bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  g.json["skins"][0]["inverseBindMatrices"] = g.add_accessor(bind, "MAT4", 5126, 2);
  expect_near(world(load(g)), {{0, 0, 0}, {1, 2, 0}, {0, 1, 0}});
}

TEST(skins, take_integers_second_sets_and_weights_that_do_not_add_up) {
  gltf_sketch g = skinned();
  const std::vector<std::uint16_t> joints = {0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  const std::vector<std::uint8_t> weights = {255, 0, 0, 0, 51, 0, 0, 0, 100, 0, 0, 0};
  const std::vector<std::uint8_t> more_joints = {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0};
  const std::vector<std::uint8_t> more_weights = {0, 0, 0, 0, 0, 0, 0, 0, 100, 0, 0, 0};
  json& attributes = primitive_of(g)["attributes"];
  attributes["JOINTS_0"] = g.add_accessor(joints, "VEC4", 5123, 3);
  attributes["WEIGHTS_0"] = g.add_accessor(weights, "VEC4", 5121, 3);
  g.json["accessors"].back()["normalized"] = true;
  attributes["JOINTS_1"] = g.add_accessor(more_joints, "VEC4", 5121, 3);
  attributes["WEIGHTS_1"] = g.add_accessor(more_weights, "VEC4", 5121, 3);
  g.json["accessors"].back()["normalized"] = true;
  expect_near(world(load(g)), bent);
  attributes.erase("WEIGHTS_1");  // joints without weights are none
  expect_near(world(load(g)), {{0, 0, 0}, {0, 2, 0}, {0, 1, 0}});
  attributes.erase("WEIGHTS_0");  // and the mesh stands where its node does
  g.json["nodes"][0]["translation"] = {0, 0, 9};
  expect_near(world(load(g)), {{0, 0, 9}, {1, 0, 9}, {0, 1, 9}});
}

TEST(skins, without_any_weight_hang_on_the_first_joint) {
  gltf_sketch g = skinned();
  const int zeros = g.add_accessor(std::vector<float>(12, 0.0f), "VEC4", 5126, 3);
  primitive_of(g)["attributes"]["WEIGHTS_0"] = zeros;
  expect_near(world(load(g)), {{0, 0, 0}, {0, 2, 0}, {0, 1, 0}});
}

TEST(skins, come_after_morph_targets) {
  gltf_sketch g = skinned();
  primitive_of(g)["targets"] = {{{"POSITION", g.add_positions({0, 0, 0, 2, 0, 0, 0, 0, 0})}}};
  g.json["nodes"][0]["weights"] = {1};
  expect_near(world(load(g)), {{0, 0, 0}, {0, 4, 0}, {-0.5f, 1, 0}});
}

// A mirrored node turns the facing of its mesh, as viewers do, though it is not where the mesh stands.
TEST(skins, of_a_mirrored_node_keep_their_fronts) {
  gltf_sketch g = skinned();
  EXPECT_EQ(flatten(load(g)).indices, (std::vector<std::uint32_t>{0, 1, 2}));
  g.add_node({{"children", {0, 1}}, {"scale", {1, 1, -1}}});
  const world_geometry w = flatten(load(g));
  EXPECT_EQ(w.indices, (std::vector<std::uint32_t>{0, 2, 1}));
  expect_near(w.positions, bent);
}

TEST(skins, change_neither_source_ids_nor_counts) {
  gltf_sketch g = skinned();
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 0}, {"skin", 0}});
  const scene s = load(g);
  EXPECT_EQ(s.polygon_count, 3u);
  ASSERT_EQ(s.draws.size(), 3u);
  EXPECT_EQ(s.draws[1].node, 3u);
  EXPECT_EQ(s.draws[2].first_source, 2u);
  EXPECT_EQ(s.draws[0].geometry, s.draws[2].geometry);
  EXPECT_NE(s.draws[0].geometry, s.draws[1].geometry);
}

TEST(skins, that_are_broken_are_refused) {
  const auto after = [](const std::function<void(gltf_sketch&)>& change) {
    gltf_sketch g = skinned();
    change(g);
    return refusal(g);
  };
  EXPECT_EQ(after([](gltf_sketch&) {}), "none");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["nodes"][0]["skin"] = 1; }), "scene.index-out-of-range");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["skins"][0]["joints"] = {1}; }), "scene.index-out-of-range");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["skins"][0]["joints"] = {1, 77}; }), "scene.index-out-of-range");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["skins"][0].erase("joints"); }), "scene.missing-field");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["skins"][0]["inverseBindMatrices"] = 0; }), "scene.accessor-type");
  EXPECT_EQ(after([](gltf_sketch& g) {
              const int one = g.add_accessor(std::vector<float>(16, 1.0f), "MAT4", 5126, 1);
              g.json["skins"][0]["inverseBindMatrices"] = one;
            }),
            "scene.bad-field");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][1]["componentType"] = 5120; }), "scene.accessor-type");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][2]["type"] = "VEC3"; }), "scene.accessor-type");
  EXPECT_EQ(after([](gltf_sketch& g) { g.json["accessors"][2]["count"] = 2; }), "scene.bad-field");
  // Joints outside the scene that are in a cycle of their own.
  EXPECT_EQ(after([](gltf_sketch& g) {
              g.json["nodes"][2]["children"] = {1};
              g.json["scenes"] = {{{"nodes", {0}}}};
            }),
            "scene.node-cycle");
  // A joint that is not there but has no weight does no harm: exporters leave anything in such places.
  EXPECT_EQ(after([](gltf_sketch& g) { g.binary[36 + 3] = 99; }), "none");
  EXPECT_EQ(after([](gltf_sketch& g) { g.binary[36 + 4] = 2; }), "scene.index-out-of-range");
}

}  // namespace
}  // namespace sightcell::scene
