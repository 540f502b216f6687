#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>

#include "gltf_sketch.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

scene load(const gltf_sketch& sketch, int scene_index = -1) {
  const temporary_folder folder;
  return load_gltf(folder.write("test.glb", sketch.glb()), scene_index);
}

std::vector<std::uint32_t> nodes_of_draws(const scene& s) {
  std::vector<std::uint32_t> out;
  for (const draw& d : s.draws) out.push_back(d.node);
  return out;
}

TEST(load_gltf, source_ids_go_depth_first_in_array_order) {
  gltf_sketch g;
  const int mesh = g.add_mesh(g.add_row_of_triangles(1));
  // 0 -> (3 -> 1), 4; 2 beside it. Numbers in the file are not the order of the walk.
  g.add_node({{"mesh", mesh}, {"children", {3, 4}}});
  g.add_node({{"mesh", mesh}});
  g.add_node({{"mesh", mesh}});
  g.add_node({{"mesh", mesh}, {"children", {1}}});
  g.add_node({{"mesh", mesh}});
  g.json["scenes"] = {{{"nodes", {2, 0}}}};
  const scene s = load(g);
  EXPECT_EQ(nodes_of_draws(s), (std::vector<std::uint32_t>{2, 0, 3, 1, 4}));
  EXPECT_EQ(s.polygon_count, 5u);
  EXPECT_EQ(s.geometries.size(), 1u);  // shared
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(s.draws[i].first_source, i);
}

TEST(load_gltf, primitives_in_order_and_points_and_lines_count_nothing) {
  gltf_sketch g;
  const int two = g.add_row_of_triangles(2), three = g.add_row_of_triangles(3);
  json primitives = json::array();
  primitives.push_back({{"attributes", {{"POSITION", two}}}, {"mode", 0}});
  primitives.push_back({{"attributes", {{"POSITION", three}}}});
  primitives.push_back({{"attributes", {{"POSITION", two}}}, {"mode", 1}});
  primitives.push_back({{"attributes", {{"POSITION", two}}}, {"mode", 4}});
  g.json["meshes"].push_back({{"primitives", primitives}});
  g.add_node({{"mesh", 0}});
  const scene s = load(g);
  ASSERT_EQ(s.draws.size(), 2u);
  EXPECT_EQ(s.draws[0].primitive, 1u);
  EXPECT_EQ(s.draws[0].polygon_count, 3u);
  EXPECT_EQ(s.draws[1].primitive, 3u);
  EXPECT_EQ(s.draws[1].first_source, 3u);
}

TEST(load_gltf, strips_and_fans_are_expanded_with_one_facing) {
  const std::vector<float> zigzag = {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0};
  gltf_sketch strip;
  strip.add_node({{"mesh", strip.add_mesh(strip.add_positions(zigzag), -1, 5)}});
  EXPECT_EQ(load(strip).geometries[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  gltf_sketch fan;
  fan.add_node({{"mesh", fan.add_mesh(fan.add_positions(zigzag), -1, 6)}});
  EXPECT_EQ(load(fan).geometries[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 3, 4}));
}

TEST(load_gltf, indices_of_all_three_widths) {
  const std::vector<std::uint8_t> bytes = {5, 4, 3, 2, 1, 0, 0, 0};
  const std::vector<std::uint16_t> shorts = {5, 4, 3, 2, 1, 0};
  const std::vector<std::uint32_t> words = {5, 4, 3, 2, 1, 0};
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(2);
  g.add_node({{"mesh", g.add_mesh(positions, g.add_accessor(bytes, "SCALAR", 5121, 6))}});
  g.add_node({{"mesh", g.add_mesh(positions, g.add_accessor(shorts, "SCALAR", 5123, 6))}});
  g.add_node({{"mesh", g.add_mesh(positions, g.add_accessor(words, "SCALAR", 5125, 6))}});
  const scene s = load(g);
  ASSERT_EQ(s.geometries.size(), 3u);
  for (const geometry& part : s.geometries) EXPECT_EQ(part.indices, words);
}

TEST(load_gltf, clusters_of_the_host) {
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(3);
  const std::vector<std::uint16_t> numbers = {9, 2, 9};
  const std::vector<std::uint8_t> others = {0, 0, 1, 0};
  const auto add = [&](int accessor) {
    const int mesh = g.add_mesh(positions);
    if (accessor >= 0) g.json["meshes"][mesh]["primitives"][0]["extras"] = {{"sightcell", {{"clusters", accessor}}}};
    g.add_node({{"mesh", mesh}});
  };
  const int of_host = g.add_accessor(numbers, "SCALAR", 5123, 3);
  add(of_host);
  add(g.add_accessor(others, "SCALAR", 5121, 3));
  add(-1);
  add(of_host);
  const scene s = load(g);
  ASSERT_EQ(s.geometries.size(), 3u) << "equal clusters share their geometry";
  EXPECT_EQ(s.geometries[0].clusters, (std::vector<std::uint32_t>{9, 2, 9}));
  EXPECT_EQ(s.geometries[1].clusters, (std::vector<std::uint32_t>{0, 0, 1}));
  EXPECT_TRUE(s.geometries[2].clusters.empty());
  gltf_sketch one;
  one.add_node({{"mesh", one.add_mesh(one.add_row_of_triangles(3))}});
  const auto fingerprint = load(one).fingerprint;
  one.json["meshes"][0]["primitives"][0]["extras"]["sightcell"]["clusters"] =
      one.add_accessor(numbers, "SCALAR", 5123, 3);
  EXPECT_EQ(load(one).fingerprint, fingerprint);
  gltf_sketch wrong = g;
  wrong.json["meshes"][0]["primitives"][0]["extras"]["sightcell"]["clusters"] =
      wrong.add_accessor(numbers, "SCALAR", 5123, 2);
  EXPECT_THROW((void)load(wrong), error) << "two numbers for three triangles";
  wrong = g;
  wrong.json["meshes"][0]["primitives"][0]["extras"]["sightcell"]["clusters"] = positions;
  EXPECT_THROW((void)load(wrong), error) << "no numbers of clusters";
  wrong.json["meshes"][0]["primitives"][0]["extras"]["sightcell"] = {1, 2};  // extras may be of any type
  EXPECT_TRUE(load(wrong).geometries[0].clusters.empty());
}

TEST(load_gltf, a_rest_that_is_no_whole_triangle_is_left_out) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_positions(std::vector<float>(5 * 3, 1.0f)))}});
  EXPECT_EQ(load(g).polygon_count, 1u);
}

TEST(load_gltf, interleaved_vertices) {
  gltf_sketch g;
  // Position and texture coordinate of three vertices, 20 bytes apart.
  const std::vector<float> mixed = {0, 0, 0, .1f, .2f, 1, 0, 0, .3f, .4f, 0, 1, 0, .5f, .6f};
  const int positions = g.add_accessor(mixed, "VEC3", 5126, 3);
  g.json["bufferViews"][0]["byteStride"] = 20;
  json uv = g.json["accessors"][0];
  uv["type"] = "VEC2";
  uv["byteOffset"] = 12;
  g.json["accessors"].push_back(uv);
  g.add_node({{"mesh", g.add_mesh(positions)}});
  g.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 1;
  const scene s = load(g);
  EXPECT_EQ(s.geometries[0].positions[2], glm::vec3(0, 1, 0));
  EXPECT_EQ(s.geometries[0].uvs[1], glm::vec2(.3f, .4f));
}

TEST(load_gltf, quantized_and_normalized_positions) {
  gltf_sketch g;
  const std::vector<std::int16_t> values = {32767, -32768, 0, 0, 16384, 0, 0, 0, 5, 0};
  g.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int plain = g.add_accessor(values, "VEC3", 5122, 3);
  const int normalized = g.add_accessor(values, "VEC3", 5122, 3);
  for (const int accessor : {plain, normalized}) g.json["accessors"][static_cast<std::size_t>(accessor)]["count"] = 3;
  g.json["accessors"][1]["normalized"] = true;
  g.add_node({{"mesh", g.add_mesh(plain)}});
  g.add_node({{"mesh", g.add_mesh(normalized)}});
  const scene s = load(g);
  EXPECT_EQ(s.geometries[0].positions[0], glm::vec3(32767, -32768, 0));
  EXPECT_EQ(s.geometries[1].positions[0], glm::vec3(1, -1, 0));
  EXPECT_FLOAT_EQ(s.geometries[1].positions[1].y, 16384.0f / 32767.0f);
}

TEST(load_gltf, sparse_accessors) {
  gltf_sketch g;
  const int positions = g.add_row_of_triangles(1);
  g.add_accessor(std::vector<std::uint16_t>{2}, "SCALAR", 5123, 1);
  g.add_accessor(std::vector<float>{7, 8, 9}, "VEC3", 5126, 1);
  g.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 2}}}};
  g.add_node({{"mesh", g.add_mesh(positions)}});
  const scene s = load(g);
  EXPECT_EQ(s.geometries[0].positions[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(s.geometries[0].positions[2], glm::vec3(7, 8, 9));
  g.json["accessors"][0].erase("bufferView");  // then all others are zero
  const scene zeros = load(g);
  EXPECT_EQ(zeros.geometries[0].positions[1], glm::vec3(0, 0, 0));
  EXPECT_EQ(zeros.geometries[0].positions[2], glm::vec3(7, 8, 9));
}

TEST(load_gltf, transforms_multiply_down_the_tree) {
  gltf_sketch g;
  const int mesh = g.add_mesh(g.add_row_of_triangles(1));
  // Move by (10, 0, 0), then turn a quarter around +y (x becomes -z), then scale by 2.
  g.add_node({{"translation", {10, 0, 0}}, {"children", {1}}});
  g.add_node({{"rotation", {0, 0.7071067811865476, 0, 0.7071067811865476}}, {"children", {2}}});
  g.add_node({{"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}}, {"mesh", mesh}});
  const world_geometry w = flatten(load(g));
  EXPECT_NEAR(w.positions[1].x, 10.0f, 1e-6f);
  EXPECT_NEAR(w.positions[1].z, -2.0f, 1e-6f);
  EXPECT_NEAR(w.positions[2].y, 2.0f, 1e-6f);
}

TEST(load_gltf, mirrored_nodes_keep_their_fronts) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}, {"scale", {1, 1, -1}}});
  const world_geometry w = flatten(load(g));
  EXPECT_EQ(w.indices, (std::vector<std::uint32_t>{0, 2, 1}));
}

TEST(load_gltf, instances_come_per_primitive) {
  gltf_sketch g;
  const int one = g.add_row_of_triangles(1), two = g.add_row_of_triangles(2);
  json primitives = json::array();
  primitives.push_back({{"attributes", {{"POSITION", one}}}});
  primitives.push_back({{"attributes", {{"POSITION", two}}}});
  g.json["meshes"].push_back({{"primitives", primitives}});
  const int moves = g.add_positions({0, 0, 0, 0, 0, 5, 0, 0, 9});
  g.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  g.add_node({{"mesh", 0},
              {"translation", {100, 0, 0}},
              {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}}}});
  const scene s = load(g);
  ASSERT_EQ(s.draws.size(), 6u);
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(s.draws[i].primitive, i / 3);
    EXPECT_EQ(s.draws[i].instance, i % 3);
    EXPECT_EQ(s.draws[i].to_world[3].x, 100.0);
  }
  EXPECT_EQ(s.draws[4].to_world[3].z, 5.0);
  EXPECT_EQ(s.polygon_count, 9u);
  EXPECT_EQ(s.geometries.size(), 2u);
}

TEST(load_gltf, default_scene_rules) {
  gltf_sketch g;
  const int mesh = g.add_mesh(g.add_row_of_triangles(1));
  for (int i = 0; i < 3; ++i) g.add_node({{"mesh", mesh}});
  g.json["nodes"][0]["children"] = {2};
  EXPECT_EQ(nodes_of_draws(load(g)), (std::vector<std::uint32_t>{0, 2, 1}));  // all roots
  g.json["scenes"] = {{{"nodes", {1}}}, {{"nodes", {0}}}};
  EXPECT_EQ(nodes_of_draws(load(g)), (std::vector<std::uint32_t>{1}));  // scene 0
  g.json["scene"] = 1;
  EXPECT_EQ(nodes_of_draws(load(g)), (std::vector<std::uint32_t>{0, 2}));  // `scene`
  EXPECT_EQ(nodes_of_draws(load(g, 0)), (std::vector<std::uint32_t>{1}));  // the caller's
  try {
    load(g, 2);
    FAIL() << "scene 2 is not there";
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "scene.no-such-scene");
    EXPECT_EQ(e.kind(), error_kind::wrong_use);
  }
}

TEST(load_gltf, materials_and_images) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  g.add_accessor(std::vector<std::uint8_t>{'p', 'n', 'g', '!'}, "SCALAR", 5121, 4);
  g.json["images"] = {{{"name", "unused"}, {"uri", "missing.png"}}, {{"bufferView", 1}, {"mimeType", "image/png"}}};
  g.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
  g.json["materials"] = {
      {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}, {"doubleSided", true}},
      {{"alphaMode", "BLEND"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 0.5}}, {"baseColorTexture", {{"index", 1}}}}}}};
  g.json["meshes"][0]["primitives"][0]["material"] = 1;
  const scene s = load(g);
  ASSERT_EQ(s.materials.size(), 2u);
  EXPECT_EQ(s.materials[0].alpha, alpha_mode::mask);
  EXPECT_EQ(s.materials[0].alpha_cutoff, 0.25f);
  EXPECT_TRUE(s.materials[0].double_sided);
  EXPECT_EQ(s.materials[0].base_color_image, no_index);
  EXPECT_EQ(s.materials[1].alpha, alpha_mode::blend);
  EXPECT_EQ(s.materials[1].base_color, glm::vec4(0.5f, 0.25f, 1, 0.5f));
  ASSERT_EQ(s.materials[1].base_color_image, 0u);  // images that nothing uses are not loaded
  EXPECT_EQ(s.images[0].encoded, (std::vector<std::uint8_t>{'p', 'n', 'g', '!'}));
  EXPECT_EQ(s.draws[0].material, 1u);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(load_gltf, a_missing_image_is_a_warning) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  g.json["images"] = {{{"uri", "missing.png"}}};
  g.json["textures"] = {{{"source", 0}}};
  g.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const scene s = load(g);
  EXPECT_EQ(s.materials[0].base_color_image, no_index);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("missing.png"), std::string::npos);
}

TEST(load_gltf, text_files_with_external_buffers_and_data_uris) {
  const temporary_folder folder;
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0}))}});
  folder.write("my buffer.bin", g.binary + "and more");
  g.json["buffers"] = {{{"uri", "my%20buffer.bin"}, {"byteLength", g.binary.size()}}};
  const scene external = load_gltf(folder.write("a.gltf", g.json.dump()));
  EXPECT_EQ(external.geometries[0].positions[1], glm::vec3(1, 0, 0));
  g.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  const scene embedded = load_gltf(folder.write("b.gltf", "\xEF\xBB\xBF" + g.json.dump()));
  EXPECT_EQ(embedded.geometries[0].positions, external.geometries[0].positions);
  EXPECT_EQ(embedded.fingerprint, external.fingerprint);
}

TEST(load_gltf, optional_extensions_are_warned_about_once) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  g.json["extensionsUsed"] = {"ACME_sparkles", "ACME_sparkles", "KHR_materials_unlit"};
  const scene s = load(g);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("ACME_sparkles"), std::string::npos);
}

// Read or without influence on the polygons: not a word, whether a file requires it or only uses it.
TEST(load_gltf, extensions_that_change_no_polygon_are_tolerated) {
  for (const char* name :
       {"KHR_materials_unlit", "KHR_materials_variants", "KHR_materials_transmission", "KHR_materials_of_the_future",
        "KHR_materials_pbrSpecularGlossiness", "ADOBE_materials_thin_transparency", "KHR_lights_punctual",
        "EXT_lights_image_based", "KHR_xmp", "KHR_xmp_json_ld", "KHR_animation_pointer", "KHR_texture_transform",
        "EXT_mesh_features", "EXT_structural_metadata", "MSFT_lod", "GODOT_single_root"}) {
    gltf_sketch g;
    g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
    g.json["extensionsUsed"] = {name};
    EXPECT_TRUE(load(g).warnings.empty()) << name;
    g.json["extensionsRequired"] = {name};
    EXPECT_TRUE(load(g).warnings.empty()) << name;
  }
}

TEST(load_gltf, what_lets_light_or_nobody_knows_what_through_hides_nothing) {
  const auto occludes = [](const json& material) {
    gltf_sketch g;
    g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
    g.json["meshes"][0]["primitives"][0]["material"] = 0;
    g.json["materials"] = json::array({material});
    g.json["textures"] = {{{"source", 0}}};
    g.json["images"] = {{{"uri", "missing.png"}}};
    const polygon_kind kind = flatten(load(g)).kinds.at(0);
    EXPECT_FALSE(kind.absent);
    return kind.occludes();
  };
  const auto transmitting = [](double factor) {
    return json{{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", factor}}}}}};
  };
  EXPECT_FALSE(occludes(transmitting(0.9)));
  EXPECT_TRUE(occludes(transmitting(0.0)));
  const json missing = {{"baseColorTexture", {{"index", 0}}}};
  EXPECT_FALSE(occludes({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", missing}}));
  EXPECT_TRUE(occludes({{"alphaMode", "MASK"}}));
  EXPECT_TRUE(occludes({{"pbrMetallicRoughness", missing}})) << "opaque has no holes";
}

TEST(load_gltf, textures_that_cannot_be_read_are_a_warning_even_when_required) {
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"}) {
    gltf_sketch g;
    g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
    g.json["extensionsUsed"] = g.json["extensionsRequired"] = {name};
    g.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    g.json["textures"] = {{{"extensions", {{name, {{"source", 0}}}}}}};
    g.json["images"] = {{{"uri", "color.ktx2"}}};
    const scene s = load(g);
    ASSERT_EQ(s.warnings.size(), 2u) << name;
    EXPECT_NE(s.warnings[0].find(name), std::string::npos);
    EXPECT_NE(s.warnings[1].find("has no PNG or JPEG image"), std::string::npos);
    EXPECT_EQ(s.materials[0].base_color_image, no_index);
  }
}

TEST(load_gltf, a_variant_and_a_light_change_nothing) {
  gltf_sketch g;
  g.add_node(
      {{"mesh", g.add_mesh(g.add_row_of_triangles(1))}, {"extensions", {{"KHR_lights_punctual", {{"light", 99}}}}}});
  g.json["materials"] = {{{"name", "red"}}, {{"name", "blue"}, {"alphaMode", "BLEND"}}};
  g.json["meshes"][0]["primitives"][0]["material"] = 0;
  g.json["meshes"][0]["primitives"][0]["extensions"] = {
      {"KHR_materials_variants", {{"mappings", {{{"material", 1}, {"variants", {0}}}}}}}};
  const scene s = load(g);
  EXPECT_EQ(s.draws[0].material, 0u);
  EXPECT_TRUE(s.warnings.empty());
}

// Its diffuse color takes the place of the base color, alpha included: leaves would else be solid.
TEST(load_gltf, specular_glossiness_materials_have_their_alpha) {
  gltf_sketch g;
  g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}});
  g.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  g.json["textures"] = {{{"source", 0}}};
  g.json["materials"] = {
      {{"alphaMode", "MASK"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}}},
       {"extensions",
        {{"KHR_materials_pbrSpecularGlossiness",
          {{"diffuseFactor", {0.5, 0.5, 0.5, 0.25}}, {"diffuseTexture", {{"index", 0}, {"texCoord", 0}}}}}}}}};
  const scene s = load(g);
  EXPECT_EQ(s.materials[0].base_color, glm::vec4(0.5f, 0.5f, 0.5f, 0.25f));
  EXPECT_EQ(s.materials[0].base_color_image, 0u);
}

TEST(load_gltf, a_very_deep_chain_of_nodes) {
  gltf_sketch g;
  const int mesh = g.add_mesh(g.add_row_of_triangles(1));
  constexpr int depth = 100000;
  for (int i = 0; i < depth; ++i) g.add_node({{"children", {i + 1}}});
  g.add_node({{"mesh", mesh}});
  EXPECT_EQ(load(g).polygon_count, 1u);
}

// Cells files name nodes: other characters in them, or fewer, and the node is not found.
TEST(load_gltf, names_of_nodes_are_kept_as_they_are) {
  for (const std::string& name : {std::string("two\nlines"), std::string(300, 'x'), std::string("\u57ce\u5e02")}) {
    gltf_sketch g;
    g.add_node({{"mesh", g.add_mesh(g.add_row_of_triangles(1))}, {"name", name}});
    EXPECT_EQ(load(g).node_names[0], name);
  }
}

// A triangle with two coordinate sets and colors, and a material that a test completes.
gltf_sketch textured_triangle(const nlohmann::json& texture_info) {
  gltf_sketch g;
  const int positions = g.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int first = g.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2", 5126, 3);
  const int second = g.add_accessor(std::vector<float>{5, 5, 6, 5, 5, 6}, "VEC2", 5126, 3);
  g.json["meshes"] = {{{"primitives",
                        {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", first}, {"TEXCOORD_1", second}}},
                          {"material", 0}}}}}};
  g.json["nodes"] = {{{"mesh", 0}}};
  g.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture_info}}}}};
  g.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  g.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  g.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  return g;
}

std::vector<glm::vec2> uvs_of(const gltf_sketch& g) {
  const temporary_folder folder;
  return load_gltf(folder.write("textured.glb", g.glb())).geometries.at(0).uvs;
}

TEST(load_gltf, the_coordinate_set_is_the_one_that_the_material_names) {
  EXPECT_EQ(uvs_of(textured_triangle({{"index", 0}})), (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(uvs_of(textured_triangle({{"index", 0}, {"texCoord", 1}})),
            (std::vector<glm::vec2>{{5, 5}, {6, 5}, {5, 6}}));
  EXPECT_TRUE(uvs_of(textured_triangle({{"index", 0}, {"texCoord", 2}})).empty()) << "the primitive has no such set";
}

TEST(load_gltf, texture_transforms_are_applied) {
  const auto transformed = [](const nlohmann::json& transform) {
    return uvs_of(textured_triangle({{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}));
  };
  EXPECT_EQ(transformed({{"offset", {0, 1}}, {"scale", {1, -1}}}), (std::vector<glm::vec2>{{0, 1}, {1, 1}, {0, 0}}));
  EXPECT_EQ(transformed({{"texCoord", 1}}), (std::vector<glm::vec2>{{5, 5}, {6, 5}, {5, 6}}));
  // The extension's own example: the lower left quadrant, turned by 90 degrees.
  const auto turned = transformed({{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}});
  const std::vector<glm::vec2> expected = {{0, 1}, {0, 0.5f}, {0.5f, 1}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(turned[i].x, expected[i].x, 1e-6) << i;
    EXPECT_NEAR(turned[i].y, expected[i].y, 1e-6) << i;
  }
}

TEST(load_gltf, materials_that_differ_in_their_coordinates_alone_split_a_shared_primitive) {
  gltf_sketch g = textured_triangle({{"index", 0}});
  const auto add = [&](const nlohmann::json& material) {
    g.json["materials"].push_back(material);
    g.json["meshes"].push_back(g.json["meshes"][0]);
    g.json["meshes"].back()["primitives"][0]["material"] = g.json["materials"].size() - 1;
    g.json["nodes"].push_back({{"mesh", g.json["meshes"].size() - 1}});
  };
  add(g.json["materials"][0]);
  add({{"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}}}}});
  add(g.json["materials"][2]);
  const temporary_folder folder;
  const scene s = load_gltf(folder.write("shared.glb", g.glb()));
  ASSERT_EQ(s.draws.size(), 4u);
  EXPECT_EQ(s.draws[0].geometry, s.draws[1].geometry);
  EXPECT_NE(s.draws[0].geometry, s.draws[2].geometry);
  EXPECT_EQ(s.draws[2].geometry, s.draws[3].geometry);
}

TEST(load_gltf, samplers_say_how_textures_wrap) {
  const temporary_folder folder;
  gltf_sketch g = textured_triangle({{"index", 0}});
  scene s = load_gltf(folder.write("a.glb", g.glb()));
  EXPECT_EQ(s.materials[0].wrap_u, wrap::clamp);
  EXPECT_EQ(s.materials[0].wrap_v, wrap::mirror);
  g.json["samplers"] = {{{"wrapS", 10497}, {"wrapT", 7}}};
  s = load_gltf(folder.write("b.glb", g.glb()));
  EXPECT_EQ(s.materials[0].wrap_u, wrap::repeat);
  EXPECT_EQ(s.materials[0].wrap_v, wrap::repeat);
  EXPECT_TRUE(std::any_of(s.warnings.begin(), s.warnings.end(),
                          [](const std::string& w) { return w.find("wrapT 7") != std::string::npos; }));
  g.json["textures"][0]["sampler"] = 4;
  EXPECT_THROW((void)load_gltf(folder.write("c.glb", g.glb())), error);
}

TEST(load_gltf, vertex_colors_of_every_kind) {
  const auto colors_of = [](const auto& values, const char* type, int component, bool normalized) {
    gltf_sketch g = textured_triangle({{"index", 0}});
    const int accessor = g.add_accessor(values, type, component, 3);
    if (normalized) g.json["accessors"].back()["normalized"] = true;
    g.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
    const temporary_folder folder;
    return load_gltf(folder.write("colors.glb", g.glb())).geometries.at(0).colors;
  };
  using colors = std::vector<glm::u8vec4>;
  EXPECT_EQ(colors_of(std::vector<float>{0, 0.2f, 1, -1, 2, 0.4f, 1, 1, 1}, "VEC3", 5126, false),
            (colors{{0, 51, 255, 255}, {0, 255, 102, 255}, {255, 255, 255, 255}}));
  EXPECT_EQ(colors_of(std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, "VEC4", 5121, true),
            (colors{{1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}}));
  EXPECT_EQ(colors_of(std::vector<std::uint16_t>{0, 65535, 257, 514, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 5123, true)[0],
            glm::u8vec4(0, 255, 1, 2));
}

TEST(load_gltf, corners_that_make_no_triangle_are_left_out_with_a_warning) {
  for (const bool indexed : {false, true}) {
    gltf_sketch g;
    const int positions = g.add_row_of_triangles(2);
    const int indices = indexed ? g.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 3, 4}, "SCALAR", 5123, 5) : -1;
    g.add_node({{"mesh", g.add_mesh(positions, indices)}});
    if (!indexed) g.json["accessors"][0]["count"] = 5;
    const std::string bytes = g.glb();
    const scene s = load_gltf(std::as_bytes(std::span(bytes)), "cut");
    EXPECT_EQ(s.polygon_count, 1u);
    ASSERT_EQ(s.warnings.size(), 1u);
    EXPECT_EQ(s.warnings[0], "meshes[0].primitives[0] has 5 corners, not whole triangles: the last ones are left out");
  }
}

}  // namespace
}  // namespace sightcell::scene
