// A scene without some of its polygons.
#include "sightcell/scene/strip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "draco_sketch.h"
#include "errors/error_id.h"
#include "gltf_sketch.h"
#include "packed_file.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;
using floats = std::vector<float>;
using id_set = std::set<std::uint32_t>;

// A file, stripped of the polygons with these source ids.
struct stripped_sketch {
  stripped_sketch(const gltf_sketch& sketch, const id_set& unwanted)
      : stripper(folder.write("sketch.glb", sketch.glb())),
        result(stripper.strip(flags(unwanted, stripper.content().polygon_count), warnings)),
        file(result.glb),
        left(file.loaded()) {}

  static std::vector<bool> flags(const id_set& ids, std::uint32_t count) {
    std::vector<bool> out(count, false);
    for (const std::uint32_t id : ids) out[id] = true;
    return out;
  }

  // The polygons that are left are those of the source but `gone`, in its order, bit by bit, with the same materials.
  void expect_gone(const id_set& gone) const {
    const scene& before = stripper.content();
    const world_geometry old_world = flatten(before), world = flatten(left);
    ASSERT_EQ(left.polygon_count, before.polygon_count - gone.size());
    ASSERT_EQ(result.polygons, left.polygon_count);
    std::uint32_t now = 0;
    for (std::uint32_t id = 0; id < before.polygon_count; ++id) {
      if (gone.contains(id)) continue;
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_EQ(world.positions[world.indices[3 * std::size_t{now} + k]],
                  old_world.positions[old_world.indices[3 * std::size_t{id} + k]])
            << "polygon " << id << ", now " << now;
      ASSERT_EQ(left.draws[draw_of(left, now)].material, before.draws[draw_of(before, id)].material);
      ASSERT_EQ(left.draws[draw_of(left, now)].node, before.draws[draw_of(before, id)].node);
      ++now;
    }
  }

  temporary_folder folder;
  gltf_stripper stripper;
  std::vector<std::string> warnings;
  stripped_scene result;
  packed_file file;
  scene left;
};

json& primitive_of(gltf_sketch& g, std::size_t mesh = 0) {
  return g.json["meshes"][mesh]["primitives"][0];
}

std::size_t vertices_of(const stripped_sketch& s, std::size_t mesh, const char* attribute = "POSITION") {
  const json& primitive = s.file.json["meshes"].at(mesh)["primitives"].at(0);
  return s.file.json["accessors"].at(primitive["attributes"].at(attribute).get<std::size_t>())["count"];
}

TEST(strip, removes_triangles_and_their_vertices) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(5));
  g.add_node({{"mesh", 0}});
  const stripped_sketch s(g, {1, 4});
  s.expect_gone({1, 4});
  EXPECT_EQ(vertices_of(s, 0), 9u);
  EXPECT_EQ(s.file.json["accessors"].size(), 2u);
  EXPECT_EQ(s.file.json["accessors"][0]["max"], json::array({4.0, 1.0, 0.0}));
  EXPECT_EQ(s.file.json["accessors"][0]["min"], json::array({0.0, 0.0, 0.0}));
  EXPECT_EQ(s.result.source_bytes, g.glb().size());
}

TEST(strip, removes_nothing_where_nothing_is_unwanted) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(5));
  g.add_node({{"mesh", 0}});
  const stripped_sketch s(g, {});
  s.expect_gone({});
  EXPECT_FALSE(s.file.json["meshes"][0]["primitives"][0].contains("indices"));
}

TEST(strip, strips_and_fans_become_triangles) {
  for (const int mode : {5, 6}) {
    gltf_sketch g;
    const std::vector<std::uint8_t> indices = {0, 1, 2, 4, 3, 5, 7};
    g.add_mesh(g.add_row_of_triangles(3), g.add_accessor(indices, "SCALAR", 5121, indices.size()), mode);
    g.add_node({{"mesh", 0}});
    const stripped_sketch s(g, {0, 3});
    s.expect_gone({0, 3});
    EXPECT_FALSE(s.file.json["meshes"][0]["primitives"][0].contains("mode"));
  }
}

TEST(strip, vertices_that_another_primitive_uses_stay) {
  gltf_sketch g;
  const int row = g.add_row_of_triangles(6);
  const std::vector<std::uint16_t> first = {0, 1, 2, 3, 4, 5}, second = {3, 4, 5, 6, 7, 8}, line = {15, 16};
  g.add_mesh(row, g.add_accessor(first, "SCALAR", 5123, 6));
  g.add_mesh(row, g.add_accessor(second, "SCALAR", 5123, 6));
  g.add_mesh(row, g.add_accessor(line, "SCALAR", 5123, 2), 1);
  for (const int mesh : {0, 1, 2}) g.add_node({{"mesh", mesh}});
  const stripped_sketch s(g, {0, 1});
  s.expect_gone({0, 1});
  ASSERT_EQ(s.file.json["meshes"].size(), 2u) << "the mesh without triangles is gone, that of lines is not";
  EXPECT_EQ(vertices_of(s, 0), 8u);
  const json& lines = s.file.json["meshes"][1]["primitives"][0];
  EXPECT_EQ(lines["mode"], 1);
  const auto ends = s.file.numbers<std::uint16_t>(lines["indices"].get<std::size_t>());
  const auto corners = s.file.numbers<float>(lines["attributes"]["POSITION"].get<std::size_t>());
  EXPECT_EQ(corners[3 * ends.at(0)], 5.0f);
  EXPECT_EQ(corners[3 * ends.at(1)], 6.0f);
}

TEST(strip, a_triangle_goes_when_all_its_instances_do) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(3));
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 0}, {"translation", {0, 5, 0}}});
  // Triangle 0 is unwanted in the first node, triangle 1 in the second, triangle 2 in both.
  const stripped_sketch s(g, {0, 4, 2, 5});
  s.expect_gone({2, 5});
}

TEST(strip, instances_of_one_node_count_too) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(3));
  const int places = g.add_positions({0, 0, 0, 0, 5, 0, 0, 9, 0});
  g.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const json instancing = {{"attributes", {{"TRANSLATION", places}}}};
  g.add_node({{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", instancing}}}});
  const stripped_sketch s(g, {0, 3, 6, 1, 4});
  s.expect_gone({0, 3, 6});
  EXPECT_EQ(s.file.json["extensionsUsed"], json::array({"EXT_mesh_gpu_instancing"}));
}

TEST(strip, nodes_of_meshes_that_are_gone_stay) {
  gltf_sketch g;
  for (const float first : {0.0f, 10.0f, 20.0f}) g.add_mesh(g.add_row_of_triangles(2, first));
  g.json["extensionsUsed"] = {"KHR_lights_punctual"};
  g.json["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
  g.add_node({{"mesh", 0},
              {"name", "crate"},
              {"children", {1}},
              {"translation", {1, 2, 3}},
              {"extras", {{"weight", 7}}},
              {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  g.add_node({{"mesh", 1}});
  g.add_node({{"mesh", 2}});
  const stripped_sketch s(g, {0, 1, 4});
  s.expect_gone({0, 1, 4});
  json expected = g.json["nodes"][0];
  expected.erase("mesh");
  EXPECT_EQ(s.file.json["nodes"][0], expected);
  EXPECT_EQ(s.file.json["nodes"][1]["mesh"], 0);
  EXPECT_EQ(s.file.json["nodes"][2]["mesh"], 1);
  EXPECT_EQ(s.file.json["extensions"], g.json["extensions"]);
  EXPECT_EQ(s.file.json["extensionsUsed"], g.json["extensionsUsed"]);
}

TEST(strip, nothing_may_be_left) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(2));
  const json instancing = {{"attributes", {{"TRANSLATION", g.add_positions({0, 0, 0})}}}};
  g.add_node({{"mesh", 0}, {"name", "all"}, {"extensions", {{"EXT_mesh_gpu_instancing", instancing}}}});
  g.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const temporary_folder folder;
  gltf_stripper stripper(folder.write("sketch.glb", g.glb()));
  std::vector<std::string> warnings;
  const stripped_scene result = stripper.strip({true, true}, warnings);
  const scene left = load_gltf(result.glb, "left.glb");
  EXPECT_EQ(left.polygon_count, 0u);
  EXPECT_EQ(left.node_names, std::vector<std::string>{"all"});
  EXPECT_TRUE(left.extensions.empty());
}

TEST(strip, meshes_with_targets_or_skins_or_of_other_scenes_stay_whole) {
  gltf_sketch morph, skin, other;
  for (gltf_sketch* g : {&morph, &skin, &other}) {
    g->add_mesh(g->add_row_of_triangles(2));
    g->add_node({{"mesh", 0}});
  }
  primitive_of(morph)["targets"] = {{{"POSITION", morph.add_positions(floats(18, 0.0f))}}};
  skin.json["skins"] = {{{"joints", {0}}}};
  skin.json["nodes"][0]["skin"] = 0;
  other.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  other.add_node({{"mesh", 0}});
  for (const gltf_sketch* g : {&morph, &skin, &other}) stripped_sketch(*g, {0}).expect_gone({});
}

TEST(strip, primitives_with_extensions_that_refer_to_triangles_stay_whole) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(2));
  g.add_node({{"mesh", 0}});
  const std::vector<std::uint16_t> edge = {0, 1};
  primitive_of(g)["extensions"] = {
      {"CESIUM_primitive_outline", {{"indices", g.add_accessor(edge, "SCALAR", 5123, 2)}}}};
  const stripped_sketch s(g, {0});
  s.expect_gone({});
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("CESIUM_primitive_outline"), std::string::npos);
  const json& outline = s.file.json["meshes"][0]["primitives"][0]["extensions"]["CESIUM_primitive_outline"];
  EXPECT_EQ(s.file.numbers<std::uint16_t>(outline["indices"].get<std::size_t>()), edge);
}

TEST(strip, attributes_keep_their_types) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(2));
  const std::vector<std::int8_t> normals = {127, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0, 5, 0, 0};
  const int normal = g.add_accessor(normals, "VEC3", 5120, 6);
  g.json["accessors"][static_cast<std::size_t>(normal)]["normalized"] = true;
  g.json["accessors"][static_cast<std::size_t>(normal)]["name"] = "N";
  g.json["bufferViews"].back()["byteLength"] = normals.size() + 6;
  g.binary += std::string(6, '\0');
  g.json["bufferViews"].back()["byteStride"] = 4;
  g.json["bufferViews"].back()["byteLength"] = 24;
  primitive_of(g)["attributes"]["NORMAL"] = normal;
  primitive_of(g)["attributes"]["TEXCOORD_0"] =
      g.add_accessor(floats{0, .1f, 1, .1f, 2, .1f, 3, .1f, 4, .1f, 5, .1f}, "VEC2", 5126, 6);
  g.json["extensionsUsed"] = g.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  g.add_node({{"mesh", 0}});
  const stripped_sketch s(g, {0});
  s.expect_gone({0});
  const json& attributes = s.file.json["meshes"][0]["primitives"][0]["attributes"];
  const json& kept = s.file.json["accessors"][attributes["NORMAL"].get<std::size_t>()];
  EXPECT_EQ(kept["componentType"], 5120);
  EXPECT_EQ(kept["normalized"], true);
  EXPECT_EQ(kept["name"], "N");
  EXPECT_EQ(kept["count"], 3);
  EXPECT_EQ(s.file.json["bufferViews"][kept["bufferView"].get<std::size_t>()]["byteStride"], 4);
  EXPECT_EQ(s.file.attribute(0, "TEXCOORD_0"), (floats{3, .1f, 4, .1f, 5, .1f}));
  EXPECT_EQ(s.file.json["extensionsRequired"], json::array({"KHR_mesh_quantization"}));
}

TEST(strip, sparse_positions_are_plain_then) {
  gltf_sketch g;
  const int row = g.add_row_of_triangles(2);
  g.add_mesh(row);
  const std::vector<std::uint16_t> at = {5};
  const int place = g.add_accessor(at, "SCALAR", 5123, 1), value = g.add_positions({7, 8, 9});
  const auto view_of = [&](int a) { return g.json["accessors"][static_cast<std::size_t>(a)]["bufferView"]; };
  g.json["accessors"][static_cast<std::size_t>(row)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", view_of(place)}, {"componentType", 5123}}},
      {"values", {{"bufferView", view_of(value)}}}};
  g.add_node({{"mesh", 0}});
  for (const id_set& gone : {id_set{0}, id_set{1}, id_set{}}) {
    const stripped_sketch s(g, gone);
    s.expect_gone(gone);
    EXPECT_FALSE(s.file.json["accessors"][0].contains("sparse"));
  }
}

TEST(strip, animations_keep_their_keyframes) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(2));
  g.add_mesh(g.add_row_of_triangles(2, 8));
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 1}});
  const int input = g.add_accessor(floats{0, 2}, "SCALAR", 5126, 2), output = g.add_positions({0, 0, 0, 1, 2, 3});
  g.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  const stripped_sketch s(g, {0, 1});
  s.expect_gone({0, 1});
  const json& sampler = s.file.json["animations"][0]["samplers"][0];
  EXPECT_EQ(s.file.numbers<float>(sampler["input"].get<std::size_t>()), (floats{0, 2}));
  EXPECT_EQ(s.file.numbers<float>(sampler["output"].get<std::size_t>()), (floats{0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(s.file.json["animations"][0]["channels"], g.json["animations"][0]["channels"]);
}

TEST(strip, animation_pointers_follow_meshes) {
  gltf_sketch g;
  for (const float first : {0.0f, 10.0f}) {
    g.add_mesh(g.add_row_of_triangles(2, first));
    g.add_node({{"mesh", first == 0.0f ? 0 : 1}});
  }
  const json pointer = {{"extensions", {{"KHR_animation_pointer", {{"pointer", "/meshes/1/weights/0"}}}}},
                        {"path", "pointer"}};
  g.json["animations"] = {{{"channels", {{{"target", pointer}}}}}};
  g.json["extensionsUsed"] = {"KHR_animation_pointer"};
  const stripped_sketch s(g, {0, 1, 2});
  s.expect_gone({0, 1});
  const json& target = s.file.json["animations"][0]["channels"][0]["target"];
  EXPECT_EQ(target["extensions"]["KHR_animation_pointer"]["pointer"], "/meshes/0/weights/0");
}

TEST(strip, draco_primitives_are_plain_where_they_lose_triangles) {
  const gltf_sketch g = draco_sketch();
  const stripped_sketch s(g, {0, 8, 5, 13});
  s.expect_gone({0, 8, 5, 13});
  EXPECT_FALSE(s.file.json.contains("extensionsRequired"));
  EXPECT_FALSE(s.file.json["meshes"][0]["primitives"][0].contains("extensions"));
  EXPECT_EQ(s.left.geometries[0].uvs.size(), s.left.geometries[0].positions.size());
  const stripped_sketch same(g, {0});
  same.expect_gone({});
  EXPECT_EQ(same.file.json["extensionsRequired"], json::array({"KHR_draco_mesh_compression"}));
}

TEST(strip, accessors_that_share_bytes_go_on_doing_so) {
  gltf_sketch g;
  const int row = g.add_row_of_triangles(100);
  g.add_mesh(row);
  g.json["accessors"].push_back(g.json["accessors"][static_cast<std::size_t>(row)]);
  g.add_mesh(static_cast<int>(g.json["accessors"].size()) - 1);
  g.add_node({{"mesh", 0}});
  g.add_node({{"mesh", 1}});
  const stripped_sketch s(g, {});
  s.expect_gone({});
  EXPECT_EQ(s.file.json["bufferViews"].size(), 1u);
}

TEST(strip, materials_and_images_stay) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(2));
  primitive_of(g)["material"] = 1;
  g.json["images"] = {{{"uri", "picture.png"}, {"name", "p"}}, {{"uri", "picture.png"}, {"name", "q"}}};
  g.json["textures"] = {{{"source", 0}}};
  const json transform = {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}};
  g.json["materials"] = {{{"name", "of nothing"}},
                         {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"extensions", transform}}}}}}};
  g.json["extensionsUsed"] = {"KHR_texture_transform"};
  g.add_node({{"mesh", 0}});
  const temporary_folder folder;
  const std::string png = std::string("\x89PNG\r\n\x1A\n") + "not a whole one";
  folder.write("picture.png", png);
  gltf_stripper stripper(folder.write("sketch.glb", g.glb()));
  std::vector<std::string> warnings;
  const stripped_scene result = stripper.strip({true, false}, warnings);
  const packed_file file(result.glb);
  for (const char* section : {"materials", "textures", "extensionsUsed"})
    EXPECT_EQ(file.json[section], g.json[section]) << section;
  EXPECT_FALSE(file.json["images"][0].contains("uri"));
  EXPECT_EQ(file.view(file.json["images"][0]["bufferView"].get<std::size_t>()).size(), png.size());
  EXPECT_EQ(file.json["images"][0]["bufferView"], file.json["images"][1]["bufferView"]);
  EXPECT_EQ(file.json["images"][1]["name"], "q");
  EXPECT_EQ(result.source_bytes, g.glb().size() + png.size());
}

TEST(strip, views_of_extensions_follow) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(2));
  g.add_node({{"mesh", 0}});
  const std::vector<std::uint8_t> data = {1, 2, 3, 4, 5};
  const int accessor = g.add_accessor(data, "SCALAR", 5121, 5);
  const json view = g.json["accessors"][static_cast<std::size_t>(accessor)]["bufferView"];
  g.json["extensions"] = {
      {"EXT_structural_metadata",
       {{"propertyTables", {{{"properties", {{"height", {{"values", view}}}}}, {"extras", {{"values", 999}}}}}}}},
      {"KHR_audio", {{"audio", {{{"bufferView", view}}}}}}};
  const stripped_sketch s(g, {1});
  const json& extensions = s.file.json["extensions"];
  const json& values = extensions["EXT_structural_metadata"]["propertyTables"][0]["properties"]["height"]["values"];
  EXPECT_EQ(s.file.view(values.get<std::size_t>()).at(4), std::byte{5});
  EXPECT_EQ(extensions["KHR_audio"]["audio"][0]["bufferView"], values);
  EXPECT_EQ(s.file.json["accessors"].size(), 2u) << "the accessor of the data is used by nothing";
}

TEST(strip, has_the_same_bytes_each_time) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(9));
  g.add_node({{"mesh", 0}});
  EXPECT_EQ(stripped_sketch(g, {3, 4}).result.glb, stripped_sketch(g, {3, 4}).result.glb);
  EXPECT_NE(stripped_sketch(g, {3, 4}).result.glb, stripped_sketch(g, {3, 5}).result.glb);
}

TEST(strip, refuses_what_contradicts_itself) {
  const auto refusal_of = [](const std::function<void(gltf_sketch&)>& change) {
    gltf_sketch g;
    g.add_mesh(g.add_row_of_triangles(2));
    primitive_of(g)["attributes"]["_HEAT"] = g.add_accessor(floats(6), "SCALAR", 5126, 6);
    g.add_node({{"mesh", 0}});
    change(g);
    return test::error_id([&] { stripped_sketch(g, {0}); });
  };
  EXPECT_EQ(refusal_of([](gltf_sketch&) {}), "");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { g.json["accessors"][1]["count"] = 5; }), "scene.bad-field");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { g.json["accessors"][1]["count"] = 7; }), "scene.accessor-bounds");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) { primitive_of(g)["attributes"]["_HEAT"] = 9; }), "scene.index-out-of-range");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) {
              g.json["animations"] = {{{"samplers", {{{"input", 9}}}}}};
            }),
            "scene.index-out-of-range");
  EXPECT_EQ(refusal_of([](gltf_sketch& g) {
              g.json["extensions"] = {{"KHR_audio", {{"bufferView", 9}}}};
            }),
            "scene.index-out-of-range");
}

TEST(strip, refuses_what_a_glb_cannot_hold) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(1));
  g.add_node({{"mesh", 0}});
  g.add_more_than_a_glb_holds();
  EXPECT_EQ(test::error_id([&] { stripped_sketch(g, {}); }), "strip.too-large");
}

}  // namespace
}  // namespace sightcell::scene
