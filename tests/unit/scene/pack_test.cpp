// The scene as one mesh in world space.
#include "sightcell/scene/pack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "draco_sketch.h"
#include "errors/error_id.h"
#include "gltf_sketch.h"
#include "packed_file.h"
#include "sightcell/scene/object_levels.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;
using numbers = std::vector<float>;

struct packed {
  explicit packed(const gltf_sketch& sketch)
      : packer(folder.write("sketch.glb", sketch.glb())),
        order(some_order(packer.content())),
        file(packer.pack(order, warnings)) {}
  const scene& source() const { return packer.content(); }

  temporary_folder folder;
  gltf_packer packer;
  packed_order order;
  std::vector<std::string> warnings;
  packed_file file;
};

json& primitive_of(gltf_sketch& g, std::size_t mesh = 0) {
  return g.json["meshes"][mesh]["primitives"][0];
}

void expect_near(const numbers& got, std::size_t from, const numbers& expected) {
  ASSERT_LE(from + expected.size(), got.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(got[from + i], expected[i], 1e-6f) << "number " << from + i;
}

// A triangle in the plane x + y = 1: front toward (1, 1, 0), with a tangent along (-1, 1, 0).
gltf_sketch slope() {
  gltf_sketch g;
  const int positions = g.add_positions({1, 0, 0, 0, 1, 0, 1, 0, 1});
  const float h = std::sqrt(0.5f);
  const int normals = g.add_positions({h, h, 0, h, h, 0, h, h, 0});
  const int tangents = g.add_accessor(numbers{-h, h, 0, 1, -h, h, 0, 1, -h, h, 0, 1}, "VEC4", 5126, 3);
  g.add_mesh(positions);
  primitive_of(g)["attributes"]["NORMAL"] = normals;
  primitive_of(g)["attributes"]["TANGENT"] = tangents;
  return g;
}

glm::vec3 corner(const packed_file& file, std::size_t group, std::size_t corner_number) {
  const numbers positions = file.attribute(group, "POSITION");
  const std::uint32_t at = file.indices(group).at(corner_number);
  return {positions[3 * at], positions[3 * at + 1], positions[3 * at + 2]};
}

glm::vec3 front(const packed_file& file, std::size_t group, std::size_t polygon) {
  const glm::vec3 a = corner(file, group, 3 * polygon);
  return glm::normalize(glm::cross(corner(file, group, 3 * polygon + 1) - a, corner(file, group, 3 * polygon + 2) - a));
}

TEST(pack, has_the_polygons_of_flatten_in_stored_order) {
  gltf_sketch g;
  g.json["materials"] = {{{"name", "a"}}, {{"name", "b"}}, {{"name", "nobody has it"}}};
  const int row = g.add_row_of_triangles(40), other = g.add_row_of_triangles(9, 0.37f);
  g.add_mesh(row);
  primitive_of(g, 0)["material"] = 1;
  g.add_mesh(other, -1, 5);  // a strip
  primitive_of(g, 1)["material"] = 0;
  const std::vector<std::uint16_t> some = {5, 4, 3, 0, 1, 2, 7, 7, 8};
  g.add_mesh(other, g.add_accessor(some, "SCALAR", 5123, 9));
  const json turned = {0.3, -0.1, 0.7, 0.64};
  g.add_node({{"mesh", 1}, {"children", {1, 2}}, {"scale", {1, 3, 0.1}}, {"rotation", turned}});
  g.add_node({{"mesh", 0}, {"translation", {0.1, 7, 1e4}}});
  g.add_node({{"mesh", 0}, {"scale", {-1, 1, 2}}});
  g.add_node({{"mesh", 2}, {"matrix", {1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 3, 3, 3, 1}}});
  const packed p(g);
  EXPECT_EQ(p.order.groups.size(), 3u);
  EXPECT_TRUE(p.warnings.empty());
  expect_flattened(p.source(), p.order, p.file);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(p.file.primitive(i)["attributes"]["POSITION"], p.file.primitive(0)["attributes"]["POSITION"]);
  EXPECT_FALSE(p.file.primitive(0).contains("material")) << "glTF's default";
  EXPECT_EQ(p.file.loaded().materials.size(), 3u);
}

TEST(pack, has_the_same_bytes_each_time) {
  gltf_sketch g = slope();
  g.add_node({{"mesh", 0}, {"scale", {1, 2, 3}}});
  const packed p(g), q(g);
  EXPECT_EQ(p.file.bytes(), q.file.bytes());
  gltf_packer again(p.folder.path() / "sketch.glb");
  std::vector<std::string> warnings;
  (void)again.pack(p.order, warnings);
  EXPECT_EQ(again.pack(p.order, warnings), p.file.bytes()) << "a second time with the same packer";
  g.json["nodes"][0]["scale"] = {1, 2, 4};
  EXPECT_NE(packed(g).file.bytes(), p.file.bytes());
}

TEST(pack, normals_turn_by_the_inverse_transpose_and_tangents_by_the_matrix) {
  gltf_sketch g = slope();
  g.add_node({{"mesh", 0}, {"scale", {2, 1, 1}}});
  const packed p(g);
  const float f = std::sqrt(5.0f);  // the plane is x / 2 + y = 1 now
  expect_near(p.file.attribute(0, "NORMAL"), 0, {1 / f, 2 / f, 0, 1 / f, 2 / f, 0, 1 / f, 2 / f, 0});
  expect_near(p.file.attribute(0, "TANGENT"), 0, {-2 / f, 1 / f, 0, 1, -2 / f, 1 / f, 0, 1});
  EXPECT_GT(glm::dot(front(p.file, 0, 0), glm::vec3(1 / f, 2 / f, 0)), 0.9999f);
}

TEST(pack, mirrored_draws_are_wound_anew_and_their_tangents_with_them) {
  gltf_sketch g = slope();
  g.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  const packed p(g);
  const float h = std::sqrt(0.5f);
  EXPECT_EQ(p.file.indices(0), (std::vector<std::uint32_t>{0, 2, 1}));
  expect_near(p.file.attribute(0, "NORMAL"), 0, {-h, h, 0});
  expect_near(p.file.attribute(0, "TANGENT"), 0, {h, h, 0, -1});
  EXPECT_GT(glm::dot(front(p.file, 0, 0), glm::vec3(-h, h, 0)), 0.9999f);
  // The bitangent, cross(normal, tangent) w, is the source's one, mirrored: that was (0, 0, 1).
  const numbers n = p.file.attribute(0, "NORMAL"), t = p.file.attribute(0, "TANGENT");
  const glm::vec3 b = glm::cross(glm::vec3(n[0], n[1], n[2]), glm::vec3(t[0], t[1], t[2])) * t[3];
  EXPECT_GT(b.z, 0.9999f);
}

TEST(pack, a_scale_of_nothing_leaves_directions_that_are_some) {
  gltf_sketch g = slope();
  g.add_node({{"mesh", 0}, {"scale", {1, 0, 1}}});
  g.add_node({{"mesh", 0}, {"scale", {0, 0, 0}}});
  const packed p(g);
  expect_near(p.file.attribute(0, "NORMAL"), 0, {0, 1, 0});  // flat on the ground
  expect_near(p.file.attribute(0, "NORMAL"), 9, {0, 1, 0});
  expect_near(p.file.attribute(0, "TANGENT"), 12, {1, 0, 0});
}

TEST(pack, what_a_primitive_lacks_has_a_value_all_the_same) {
  gltf_sketch g = slope();
  g.json["materials"] = {json::object(), json::object()};
  const int plain = g.add_row_of_triangles(1);  // in the plane z = 0, front toward +z
  g.add_mesh(plain);
  g.add_mesh(plain);
  primitive_of(g, 0)["material"] = primitive_of(g, 1)["material"] = 0;
  primitive_of(g, 2)["material"] = 1;
  const int uvs = g.add_accessor(numbers{.1f, .2f, .3f, .4f, .5f, .6f}, "VEC2", 5126, 3);
  const int rgb = g.add_accessor(std::vector<std::uint8_t>{255, 0, 51, 255, 0, 51, 255, 0, 51}, "VEC3", 5121, 3);
  g.json["accessors"][static_cast<std::size_t>(rgb)]["normalized"] = true;
  const int rgba = g.add_accessor(numbers{1, 1, 1, .5f, 1, 1, 1, .5f, 1, 1, 1, .5f}, "VEC4", 5126, 3);
  primitive_of(g, 0)["attributes"]["TEXCOORD_1"] = uvs;
  primitive_of(g, 0)["attributes"]["COLOR_0"] = rgb;
  primitive_of(g, 2)["attributes"]["COLOR_0"] = rgba;
  primitive_of(g, 2)["attributes"]["_HEAT"] = uvs;
  for (const int mesh : {0, 1, 2}) g.add_node({{"mesh", mesh}});
  const packed p(g);
  ASSERT_EQ(p.order.groups.size(), 2u);  // the last material's is the first
  EXPECT_EQ(p.file.primitive(0)["attributes"].size(), 2u) << "what none of its draws has is left to who draws it";
  EXPECT_EQ(p.file.primitive(1)["attributes"].size(), 5u);
  expect_near(p.file.attribute(1, "NORMAL"), 9, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  expect_near(p.file.attribute(1, "TANGENT"), 12, {1, 0, 0, 1});
  expect_near(p.file.attribute(1, "TEXCOORD_1"), 0, {.1f, .2f, .3f, .4f, .5f, .6f, 0, 0});
  expect_near(p.file.attribute(1, "COLOR_0"), 0, {1, 0, .2f, 1, 1, 0, .2f, 1, 1, 0, .2f, 1, 1, 1, 1, 1});
  expect_near(p.file.attribute(0, "COLOR_0"), 24, {1, 1, 1, .5f});
  expect_flattened(p.source(), p.order, p.file);
}

TEST(pack, normals_that_a_file_packs_into_bytes_are_floats) {
  gltf_sketch g = slope();
  const std::vector<std::int8_t> packed_normals = {127, 0, 0, 0, 0, -127, 0, 0, -128, 0, 0, 0};
  const int normals = g.add_accessor(packed_normals, "VEC3", 5120, 3);
  json& accessor = g.json["accessors"][static_cast<std::size_t>(normals)];
  accessor["normalized"] = true;
  g.json["bufferViews"].back()["byteStride"] = 4;
  const std::vector<std::uint16_t> one = {2};
  const int at = g.add_accessor(one, "SCALAR", 5123, 1);
  const int value = g.add_accessor(std::vector<std::int8_t>{0, 0, 127}, "VEC3", 5120, 1);
  const auto view_of = [&](int a) { return g.json["accessors"][static_cast<std::size_t>(a)]["bufferView"]; };
  g.json["accessors"][static_cast<std::size_t>(normals)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", view_of(at)}, {"componentType", 5123}}},
      {"values", {{"bufferView", view_of(value)}}}};
  primitive_of(g)["attributes"]["NORMAL"] = normals;
  g.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  g.add_node({{"mesh", 0}});
  const packed p(g);
  expect_near(p.file.attribute(0, "NORMAL"), 0, {1, 0, 0, 0, -1, 0, 0, 0, 1});
  EXPECT_FALSE(p.file.json.contains("extensionsUsed")) << "numbers are plain now";
}

TEST(pack, draws_that_move_stay_nodes_in_their_own_space) {
  gltf_sketch g = slope();
  const json marked = {{"sightcell", {{"dynamic", true}, {"group", "door 3"}}}};
  g.add_node({{"mesh", 0}, {"name", "door"}, {"translation", {5, 0, 0}}, {"scale", {-2, 1, 1}}, {"extras", marked}});
  g.add_node({{"mesh", 0}, {"translation", {0, 4, 0}}, {"children", {2}}});
  g.add_node({{"mesh", 0}, {"name", "wheel"}, {"translation", {0, 0, 3}}});
  g.json["animations"] = {{{"channels", {{{"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
  const packed p(g);
  ASSERT_EQ(p.order.groups.size(), 3u);
  expect_flattened(p.source(), p.order, p.file);
  const float h = std::sqrt(0.5f);
  const json &wheel = p.file.json["nodes"][0], &still = p.file.json["nodes"][1], &door = p.file.json["nodes"][2];
  EXPECT_EQ(wheel["name"], "wheel");
  EXPECT_EQ(wheel.at("matrix").at(13), 4.0);
  EXPECT_EQ(wheel.at("matrix").at(14), 3.0);
  EXPECT_EQ(wheel.at("extras").at("source").at("node"), 2);
  EXPECT_EQ(p.file.indices(0), (std::vector<std::uint32_t>{6, 7, 8}));
  expect_near(p.file.attribute(0, "POSITION"), 18, {1, 0, 0, 0, 1, 0});
  EXPECT_FALSE(still.contains("matrix"));
  EXPECT_EQ(door.at("extras").at("sightcell"), marked["sightcell"]);
  EXPECT_EQ(p.file.indices(2), (std::vector<std::uint32_t>{0, 1, 2})) << "its matrix mirrors it";
  expect_near(p.file.attribute(2, "NORMAL"), 0, {h, h, 0});
  expect_near(p.file.attribute(2, "TANGENT"), 0, {-h, h, 0, 1});
  EXPECT_TRUE(p.file.loaded().draws[2].tags.dynamic);
}

TEST(pack, directions_follow_targets_and_joints_to_where_they_rest) {
  gltf_sketch g = slope();
  const int zero = g.add_positions(numbers(9, 0.0f));
  const int up = g.add_positions({0, 2, 0, 0, 2, 0, 0, 2, 0});
  primitive_of(g)["targets"] = {{{"POSITION", zero}, {"NORMAL", zero}},
                                {{"POSITION", zero}, {"NORMAL", up}, {"TANGENT", up}}};
  g.json["meshes"][0]["weights"] = {0.25, 0.5};
  primitive_of(g)["attributes"]["JOINTS_0"] =
      g.add_accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 5121, 3);
  primitive_of(g)["attributes"]["WEIGHTS_0"] =
      g.add_accessor(numbers{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 5126, 3);
  g.json["skins"] = {{{"joints", {1, 2}}}};
  g.add_node({{"mesh", 0}, {"skin", 0}, {"translation", {50, 50, 50}}});
  g.add_node({{"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}});  // a quarter about z: x becomes y, y becomes -x
  g.add_node({{"scale", {-1, 1, 1}}});
  const packed p(g);
  expect_flattened(p.source(), p.order, p.file);
  const float h = std::sqrt(0.5f), n = std::sqrt(h * h + (h + 1) * (h + 1));
  const float x = h / n, y = (h + 1) / n;
  expect_near(p.file.attribute(0, "NORMAL"), 0, {-y, x, 0, -y, x, 0, -x, y, 0});
  expect_near(p.file.attribute(0, "TANGENT"), 0, {-y, -x, 0, 1, -y, -x, 0, 1, x, y, 0, -1});
}

TEST(pack, brings_materials_and_all_their_images) {
  gltf_sketch g = slope();
  const std::string png = std::string("\x89PNG\r\n\x1A\n") + "not a whole one";
  const std::string jpeg = "\xFF\xD8\xFF and so on, of odd length";
  const int inside = g.add_accessor(std::vector<char>(jpeg.begin(), jpeg.end()), "SCALAR", 5121, jpeg.size());
  g.json["images"] = {
      {{"uri", "folder/outside%20it.png"}, {"name", "outside"}},
      {{"bufferView", g.json["accessors"][static_cast<std::size_t>(inside)]["bufferView"]}, {"mimeType", "image/jpeg"}},
      {{"uri", "data:image/png;base64,iVBORw0KGgo="}},
      {{"uri", "nowhere.png"}}};
  g.json["samplers"] = {{{"wrapS", 33071}}};
  g.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}}, {{"source", 3}}};
  g.json["materials"] = {{{"name", "all of it"},
                          {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"roughnessFactor", 0.25}}},
                          {"normalTexture", {{"index", 1}, {"texCoord", 1}}},
                          {"extensions", {{"KHR_materials_ior", {{"ior", 1.4}}}}}}};
  g.json["extensionsUsed"] = {"KHR_materials_ior", "KHR_lights_punctual"};
  g.json["asset"]["copyright"] = "2001 who made it";
  primitive_of(g)["material"] = 0;
  g.add_node({{"mesh", 0}});
  const temporary_folder folder;
  std::filesystem::create_directory(folder.path() / "folder");
  folder.write("folder/outside it.png", png);
  gltf_packer packer(folder.write("sketch.glb", g.glb()));
  std::vector<std::string> warnings;
  const packed_file file(packer.pack(some_order(packer.content()), warnings));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("nowhere.png"), std::string::npos);
  const auto text_of = [&](std::size_t image) {
    const std::vector<std::byte> bytes = file.view(file.json["images"][image]["bufferView"].get<std::size_t>());
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  EXPECT_EQ(text_of(0), png);
  EXPECT_EQ(text_of(1), jpeg);
  EXPECT_EQ(text_of(2), png.substr(0, 8));
  for (const std::size_t image : {0u, 1u, 2u}) EXPECT_FALSE(file.json["images"][image].contains("uri"));
  EXPECT_EQ(file.json["images"][0]["mimeType"], "image/png");
  EXPECT_EQ(file.json["images"][0]["name"], "outside");
  for (const char* section : {"materials", "textures", "samplers"})
    EXPECT_EQ(file.json[section], g.json[section]) << section;
  EXPECT_EQ(file.json["extensionsUsed"], json::array({"KHR_materials_ior"}));
  EXPECT_EQ(file.json["asset"]["copyright"], "2001 who made it");
  const scene again = file.loaded();
  ASSERT_EQ(again.images.size(), 1u);  // of base colors
  EXPECT_EQ(again.images[0].encoded, packer.content().images[0].encoded);
  EXPECT_EQ(again.materials[0].wrap_u, wrap::clamp);
}

TEST(pack, levels_of_detail_stay_levels) {
  gltf_sketch g = slope();
  g.add_node({{"mesh", 0}, {"extensions", {{"MSFT_lod", {{"ids", {1}}}}}}});
  g.add_node({{"mesh", 0}, {"translation", {1, 0, 0}}});
  g.add_node({{"mesh", 0}, {"translation", {2, 0, 0}}});
  g.json["extensionsUsed"] = {"MSFT_lod"};
  const packed p(g);
  ASSERT_EQ(p.order.groups.size(), 3u);
  EXPECT_EQ(p.file.json["nodes"].size(), 5u) << "a node for each level behind the groups";
  expect_flattened(p.source(), p.order, p.file);
  const scene again = p.file.loaded();
  const world_geometry world = flatten(again);
  EXPECT_EQ(world.lods.size(), 1u);
  EXPECT_EQ(world.absent.coarser_level, 1u);
  EXPECT_TRUE(again.warnings.empty());
}

// What a reader finds of the switches of a packed file, and what of those of its source.
TEST(pack, levels_begin_where_they_did) {
  gltf_sketch g = slope();
  g.json["extensionsUsed"] = {"MSFT_lod"};
  g.add_node({{"mesh", 0},
              {"name", "near"},
              {"extensions", {{"MSFT_lod", {{"ids", json::array({1})}}}}},
              {"extras", {{"MSFT_screencoverage", {0.5, 0.01}}}}});
  g.add_node({{"mesh", 0}, {"translation", {1, 0, 0}}});
  const auto add_level = [&g](const char* of, double x, json from) {
    json marks = {{"level_of", of}};
    if (!from.is_null()) marks["from_distance"] = from;
    g.add_node({{"mesh", 0}, {"translation", {x, 0, 0}}, {"extras", {{"sightcell", marks}}}});
  };
  add_level("near", 3, 80.25);  // both kinds, of which the farther one is first in the file
  add_level("near", 2, 40.5);
  g.add_node({{"mesh", 0}, {"name", "other"}, {"translation", {9, 0, 0}}});
  add_level("other", 10, 25);
  add_level("other", 11, nullptr);
  const packed p(g);
  const auto path =
      p.folder.write("packed.glb", {reinterpret_cast<const char*>(p.file.bytes().data()), p.file.bytes().size()});
  const scene again = p.file.loaded();
  EXPECT_TRUE(again.warnings.empty());
  const object_levels levels = load_object_levels(path, again);
  ASSERT_EQ(levels.objects.size(), 2u);
  // Objects are numbered by their first draws, whose order is that of the bake.
  const leveled_object& near = levels.objects[levels.objects[0].coarser.size() == 3 ? 0 : 1];
  const leveled_object& other = levels.objects[levels.objects[0].coarser.size() == 3 ? 1 : 0];
  ASSERT_EQ(near.coarser.size(), 3u);
  EXPECT_EQ(near.coarser[0].begins.below_coverage, 0.5f);
  EXPECT_EQ(near.coarser[1].begins.from_distance, 40.5f);
  EXPECT_EQ(near.coarser[2].begins.from_distance, 80.25f);
  EXPECT_EQ(near.least_coverage, 0.01f);
  const world_geometry coarser = flatten(levels.coarser);
  const float x = coarser.positions[coarser.indices[3 * std::size_t{near.coarser[1].polygons.first}]].x;
  const float x_of_farther = coarser.positions[coarser.indices[3 * std::size_t{near.coarser[2].polygons.first}]].x;
  EXPECT_LT(x, x_of_farther) << "the level at x = 2 begins nearer";
  ASSERT_EQ(other.coarser.size(), 2u);
  EXPECT_EQ(other.coarser[0].begins.from_distance, 25.0f);
  EXPECT_FALSE(other.coarser[1].begins.from_distance.has_value());
}

TEST(pack, a_corner_that_is_nowhere_draws_nothing) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  gltf_sketch g;
  const int positions = g.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, 1, 1, 1, 2, 2, 0});
  g.add_node({{"mesh", g.add_mesh(positions)}});
  primitive_of(g)["attributes"]["TEXCOORD_0"] =
      g.add_accessor(numbers{nan, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC2", 5126, 6);
  const packed p(g);
  EXPECT_EQ(p.file.indices(0), (std::vector<std::uint32_t>{3, 3, 3, 0, 1, 2}));
  for (const char* name : {"POSITION", "TEXCOORD_0"})
    for (const float v : p.file.attribute(0, name)) EXPECT_TRUE(std::isfinite(v));
}

TEST(pack, attributes_come_out_of_a_draco_stream_too) {
  const packed p(draco_sketch());
  const numbers uvs = p.file.attribute(0, "TEXCOORD_0"), positions = p.file.attribute(0, "POSITION");
  ASSERT_EQ(uvs.size(), 40u) << "two instances of ten vertices";
  for (std::size_t i = 0; i < 10; ++i) {  // the sketch has u = x / 4 and v = y
    EXPECT_NEAR(uvs[2 * i], positions[3 * i] / 4, 1e-3f);
    EXPECT_NEAR(uvs[2 * i + 1], positions[3 * i + 1], 1e-3f);
    EXPECT_EQ(uvs[20 + 2 * i], uvs[2 * i]);
  }
  expect_flattened(p.source(), p.order, p.file);
  EXPECT_FALSE(p.file.json.contains("extensionsRequired"));
}

TEST(pack, says_which_order_it_has) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(3))}});
  packed p(g);
  const json before = p.file.json["asset"]["extras"]["sightcell"];
  std::swap(p.order.source_of_stored[0], p.order.source_of_stored[1]);
  const json after = packed_file(p.packer.pack(p.order, p.warnings)).json["asset"]["extras"]["sightcell"];
  EXPECT_EQ(before["scene"], after["scene"]);
  EXPECT_NE(before["order"], after["order"]);
  EXPECT_EQ(before["order"].get<std::string>().size(), 16u);
}

TEST(pack, refuses_attributes_that_are_none) {
  const auto refusal_of = [](const std::function<void(gltf_sketch&)>& change) {
    gltf_sketch g = slope();
    g.add_node({{"mesh", 0}});
    change(g);
    return test::error_id([&] { (void)packed(g); });
  };
  EXPECT_EQ(refusal_of([](gltf_sketch&) {}), "");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { g.json["accessors"][1]["count"] = 2; }), "scene.bad-field");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { g.json["accessors"][1]["type"] = "VEC2"; }), "scene.accessor-type");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { g.json["accessors"][1]["bufferView"] = 77; }), "scene.index-out-of-range");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { g.json["bufferViews"][1]["byteLength"] = 20; }), "scene.accessor-bounds");
}

TEST(pack, refuses_what_a_glb_cannot_hold) {
  gltf_sketch g;
  g.json["accessors"] = {{{"componentType", 5126}, {"count", 6000}, {"type", "VEC3"}}};
  const std::vector<std::uint16_t> one = {0, 1, 2};
  g.add_mesh(0, g.add_accessor(one, "SCALAR", 5123, 3));
  // Instances that are all zero take no bytes in the file.
  g.json["accessors"].push_back({{"componentType", 5126}, {"count", 60000}, {"type", "VEC3"}});
  const json instancing = {{"attributes", {{"TRANSLATION", 2}}}};
  g.add_node({{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", instancing}}}});
  EXPECT_EQ(test::error_id([&] { (void)packed(g); }), "pack.too-large");
}

}  // namespace
}  // namespace sightcell::scene
