// Pages of a streamed scene, read back by the import like any other .glb.
#include "sightcell/scene/stream_pages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "unit/scene/gltf_sketch.h"

namespace sightcell::scene {
namespace {

using triangle = std::array<std::array<float, 3>, 3>;

// A wavy sheet of 2 x side x side triangles with texture coordinates and normals.
struct sheet {
  static constexpr int side = 12;
  std::vector<float> positions, coordinates, normals;
  std::vector<std::uint16_t> indices;

  explicit sheet(float size = 10.0f) {
    for (int z = 0; z <= side; ++z)
      for (int x = 0; x <= side; ++x) {
        const float u = static_cast<float>(x) / side, v = static_cast<float>(z) / side;
        positions.insert(positions.end(), {size * u, std::sin(7.0f * u + 3.0f * v), size * v});
        coordinates.insert(coordinates.end(), {3.1f * u, 1.7f * v});
        const float nx = std::sin(5.0f * u), ny = std::cos(5.0f * u);
        normals.insert(normals.end(), {nx, ny, 0.0f});
      }
    for (int z = 0; z < side; ++z)
      for (int x = 0; x < side; ++x) {
        const auto a = static_cast<std::uint16_t>(z * (side + 1) + x);
        const auto b = static_cast<std::uint16_t>(a + side + 1);
        for (const int i : {a + 0, b + 0, a + 1, a + 1, b + 0, b + 1}) indices.push_back(static_cast<std::uint16_t>(i));
      }
  }

  int add_to(gltf_sketch& g) const {
    const int mesh = g.add_mesh(g.add_positions(positions), g.add_accessor(indices, "SCALAR", 5123, indices.size()));
    auto& attributes = g.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0]["attributes"];
    attributes["TEXCOORD_0"] = g.add_accessor(coordinates, "VEC2", 5126, coordinates.size() / 2);
    attributes["NORMAL"] = g.add_accessor(normals, "VEC3", 5126, normals.size() / 3);
    return mesh;
  }
};

triangle corners_of(const geometry& g, std::size_t polygon) {
  triangle t;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 p = g.positions[g.indices[3 * polygon + k]];
    t[k] = {p.x, p.y, p.z};
  }
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());  // codes of triangles may turn them
  return t;
}

std::vector<triangle> triangles_of(const geometry& g) {
  std::vector<triangle> out;
  for (std::size_t i = 0; i < g.indices.size() / 3; ++i) out.push_back(corners_of(g, i));
  std::sort(out.begin(), out.end());
  return out;
}

nlohmann::json document_of(const std::vector<std::byte>& page) {
  std::uint32_t size = 0;
  std::memcpy(&size, &page[12], 4);
  const auto* const text = reinterpret_cast<const char*>(&page[20]);
  return nlohmann::json::parse(text, text + size);
}

class stream_pages_test : public testing::Test {
 protected:
  gltf_pager& pager_of(gltf_sketch& g, const page_settings& how = {}) {
    pager_.emplace(folder_.write("scene.glb", g.glb()));
    pager_->prepare(how, warnings_);
    return *pager_;
  }
  std::vector<std::uint32_t> all(std::uint32_t geometry) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < pager_->geometries()[geometry].polygon_count; ++i) out.push_back(i);
    return out;
  }

  temporary_folder folder_;
  std::optional<gltf_pager> pager_;
  std::vector<std::string> warnings_;
};

TEST_F(stream_pages_test, an_ordinary_import_reads_a_page) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  const gltf_pager& pager = pager_of(g);
  const std::vector<std::byte> file = pager.page(std::vector<page_part>{{0, all(0)}});
  const scene page = load_gltf(file, "page");
  ASSERT_EQ(page.draws.size(), 1u);
  const geometry &made = page.geometries[0], &source = pager.content().geometries[0];
  ASSERT_EQ(made.indices.size(), source.indices.size());
  EXPECT_EQ(made.positions.size(), source.positions.size());  // each vertex once
  const std::vector<triangle> a = triangles_of(made), b = triangles_of(source);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[i][k][axis], b[i][k][axis], 0.5 / 4096);
}

// The extension has version 0 of the vertex codec and version 1 of the index codec.
TEST_F(stream_pages_test, streams_have_the_versions_of_the_extension) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  const gltf_pager& pager = pager_of(g);
  const std::vector<std::byte> file = pager.page(std::vector<page_part>{{0, all(0)}});
  std::uint32_t json_size = 0;
  std::memcpy(&json_size, &file[12], 4);
  const nlohmann::json json = document_of(file);
  ASSERT_EQ(json["bufferViews"].size(), 3u);
  for (const nlohmann::json& view : json["bufferViews"]) {
    const nlohmann::json& code = view["extensions"]["EXT_meshopt_compression"];
    const auto first = std::to_integer<unsigned>(file[28 + json_size + code.value("byteOffset", std::size_t{0})]);
    EXPECT_EQ(first, code["mode"] == "TRIANGLES" ? 0xE1u : 0xA0u);
  }
}

// Of a page of 16 KB it is a tenth.
TEST_F(stream_pages_test, json_of_a_page_is_short) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  const std::vector<std::byte> file = pager_of(g).page(std::vector<page_part>{{0, all(0)}});
  std::uint32_t json_size = 0;
  std::memcpy(&json_size, &file[12], 4);
  EXPECT_LE(json_size, 1'450u);
}

TEST_F(stream_pages_test, pages_of_one_geometry_meet_exactly) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  const gltf_pager& pager = pager_of(g, {.grid = 0.01});
  std::vector<triangle> apart;
  std::vector<std::uint32_t> even, odd;
  for (const std::uint32_t polygon : all(0)) (polygon % 2 == 0 ? even : odd).push_back(polygon);
  for (const auto& polygons : {even, odd})
    for (const triangle& t :
         triangles_of(load_gltf(pager.page(std::vector<page_part>{{0, polygons}}), "p").geometries[0]))
      apart.push_back(t);
  std::sort(apart.begin(), apart.end());
  const std::vector<triangle> whole =
      triangles_of(load_gltf(pager.page(std::vector<page_part>{{0, all(0)}}), "p").geometries[0]);
  EXPECT_EQ(apart, whole);
  for (const triangle& t : whole)  // on a grid of a power of two
    for (const auto& corner : t)
      for (const float value : corner) EXPECT_EQ(value * 128.0f, std::round(value * 128.0f));
}

TEST_F(stream_pages_test, steps_are_finer_where_a_draw_is_enlarged) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}, {"scale", {16, 16, 16}}});
  const gltf_pager& pager = pager_of(g, {.grid = 0.0625});
  const scene page = load_gltf(pager.page(std::vector<page_part>{{0, all(0)}}), "p");
  bool fine = false;
  for (const glm::vec3& p : page.geometries[0].positions) {
    EXPECT_EQ(p.y * 256.0f, std::round(p.y * 256.0f));  // 0.0625 / 16
    fine = fine || p.y * 128.0f != std::round(p.y * 128.0f);
  }
  EXPECT_TRUE(fine);
}

TEST_F(stream_pages_test, equal_primitives_are_one_geometry) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  g.add_node({{"mesh", sheet().add_to(g)}});  // other accessors, the same numbers
  g.add_node({{"mesh", sheet(11.0f).add_to(g)}});
  g.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
  const gltf_pager& pager = pager_of(g);
  EXPECT_EQ(pager.geometries().size(), 2u);
  EXPECT_EQ(pager.geometry_of_draw(), (std::vector<std::uint32_t>{0, 0, 1}));
}

TEST_F(stream_pages_test, polygons_without_area_are_left_out) {
  gltf_sketch g;
  const float nan = std::nanf("");
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 1e-5f, 0, 0, nan, 0, 0};
  const std::vector<std::uint16_t> indices{0, 1, 2, 0, 3, 2, 0, 1, 4};
  g.add_node({{"mesh", g.add_mesh(g.add_positions(positions), g.add_accessor(indices, "SCALAR", 5123, 9))}});
  const gltf_pager& pager = pager_of(g);
  EXPECT_TRUE(pager.is_drawn(0, 0));
  EXPECT_FALSE(pager.is_drawn(0, 1));  // corners coincide after rounding
  EXPECT_FALSE(pager.is_drawn(0, 2));
  const scene page = load_gltf(pager.page(std::vector<page_part>{{0, all(0)}}), "p");
  EXPECT_EQ(page.polygon_count, 1u);
}

TEST_F(stream_pages_test, a_page_has_several_sets_of_attributes) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
  g.add_node({{"mesh", g.add_mesh(g.add_positions(positions))}});
  g.json["scenes"] = {{{"nodes", {0, 1}}}};
  const gltf_pager& pager = pager_of(g);
  const std::vector<page_part> parts{{0, all(0)}, {1, all(1)}};
  const std::vector<std::byte> file = pager.page(parts);
  const scene page = load_gltf(file, "p");
  ASSERT_EQ(page.draws.size(), 2u);
  EXPECT_EQ(page.polygon_count, 2u * sheet::side * sheet::side + 1u);
  EXPECT_EQ(file, pager.page(parts));
}

TEST_F(stream_pages_test, images_are_what_their_materials_use_them_for) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  for (int i = 0; i < 7; ++i) {
    g.json["images"].push_back({{"uri", "data:image/png;base64,iVBORw0KGgo="}});
    g.json["textures"].push_back({{"source", i}});
  }
  const auto texture = [](int number) { return nlohmann::json{{"index", number}}; };
  const auto base = [&](int number) { return nlohmann::json{{"baseColorTexture", texture(number)}}; };
  g.json["materials"] = {
      {{"pbrMetallicRoughness", base(0)}, {"normalTexture", texture(1)}, {"occlusionTexture", texture(2)}},
      {{"pbrMetallicRoughness", base(3)}, {"alphaMode", "BLEND"}, {"emissiveTexture", texture(4)}},
      {{"pbrMetallicRoughness", base(5)}, {"alphaMode", "MASK"}, {"alphaCutoff", 0.25}},
      {{"pbrMetallicRoughness", base(5)}, {"normalTexture", texture(6)}, {"occlusionTexture", texture(6)}}};
  g.json["materials"][2]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  const std::vector<streamed_image>& images = pager_of(g).images();
  const std::array<image_use, 7> expected = {{{.is_color = true},
                                              {.has_normals = true},
                                              {.alpha = alpha_use::number},
                                              {.is_color = true, .alpha = alpha_use::blended},
                                              {.is_color = true},
                                              {.is_color = true, .alpha = alpha_use::tested},
                                              {.alpha = alpha_use::number}}};
  ASSERT_EQ(images.size(), expected.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    EXPECT_EQ(images[i].use.is_color, expected[i].is_color) << i;
    EXPECT_EQ(images[i].use.has_normals, expected[i].has_normals) << i;
    EXPECT_EQ(images[i].use.alpha, expected[i].alpha) << i;
  }
  EXPECT_EQ(images[5].use.cutoff, 0.5f);
}

TEST_F(stream_pages_test, attributes_that_no_texture_needs_are_left_out) {
  const auto texture = [](int set) { return nlohmann::json{{"index", 0}, {"texCoord", set}}; };
  nlohmann::json moved = texture(0);
  moved["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}};
  const std::vector<nlohmann::json> materials = {
      {{"name", "plain"}},
      {{"emissiveTexture", texture(0)}},
      {{"pbrMetallicRoughness", {{"baseColorTexture", moved}}}},
      {{"normalTexture", texture(1)}},
      {{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", texture(0)}}}}}},
      {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}},
      {{"extras", {{"baked", {{"lights", {texture(1)}}}}}}}};
  const std::vector<std::set<std::string>> expected = {
      {},          {"TEXCOORD_0"}, {"TEXCOORD_1"}, {"TANGENT", "TEXCOORD_1"}, {"TANGENT", "TEXCOORD_0"},
      {"TANGENT"}, {"TEXCOORD_1"}};
  gltf_sketch g;
  const sheet one;
  for (std::size_t i = 0; i <= materials.size(); ++i) {
    const int mesh = one.add_to(g);
    nlohmann::json& primitive = g.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0];
    const std::size_t vertices = one.coordinates.size() / 2;
    primitive["attributes"]["TEXCOORD_1"] = g.add_accessor(one.coordinates, "VEC2", 5126, vertices);
    primitive["attributes"]["TANGENT"] = g.add_accessor(std::vector<float>(4 * vertices, 0.5f), "VEC4", 5126, vertices);
    if (i < materials.size()) primitive["material"] = i;
    g.add_node({{"mesh", mesh}});
    g.json["scenes"] = {{{"nodes", nlohmann::json::array()}}};
  }
  for (std::size_t i = 0; i <= materials.size(); ++i) g.json["scenes"][0]["nodes"].push_back(i);
  g.json["materials"] = materials;
  g.json["images"] = {{{"uri", "data:image/png;base64,iVBORw0KGgo="}}};
  g.json["textures"] = {{{"source", 0}}};
  const auto names_of = [&](const gltf_pager& pager, std::size_t draw) {
    std::set<std::string> names;
    const nlohmann::json page =
        document_of(pager.page(std::vector<page_part>{{pager.geometry_of_draw()[draw], {0, 1}}}));
    for (const auto& [name, number] : page["meshes"][0]["primitives"][0]["attributes"].items()) names.insert(name);
    return names;
  };
  const std::set<std::string> always{"POSITION", "NORMAL"};
  for (const bool textures : {true, false}) {
    const gltf_pager& pager = pager_of(g, {.textures = textures});
    for (std::size_t i = 0; i <= materials.size(); ++i) {
      std::set<std::string> names = always;
      if (i < materials.size()) names.insert(expected[i].begin(), expected[i].end());
      EXPECT_EQ(names_of(pager, i), names) << i;
    }
  }
  const gltf_pager& pager = pager_of(g, {.all_attributes = true});
  EXPECT_EQ(names_of(pager, 0), (std::set<std::string>{"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1"}));
}

TEST_F(stream_pages_test, geometries_without_texture_coordinates_share_a_primitive_with_others) {
  gltf_sketch g;
  for (const char* const kind : {"plain", "textured", "without normals"}) {
    const int mesh = sheet(std::string_view(kind) == "plain" ? 10.0f : 12.0f).add_to(g);
    nlohmann::json& primitive = g.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0];
    if (std::string_view(kind) == "textured") primitive["material"] = 0;
    if (std::string_view(kind) == "without normals") primitive["attributes"].erase("NORMAL");
    g.add_node({{"mesh", mesh}});
  }
  g.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
  g.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
  g.json["textures"] = {{{"source", 0}}};
  g.json["images"] = {{{"uri", "data:image/png;base64,iVBORw0KGgo="}}};
  const gltf_pager& pager = pager_of(g);
  const std::vector<std::byte> file = pager.page(std::vector<page_part>{{0, all(0)}, {1, all(1)}, {2, all(2)}});
  const nlohmann::json primitives = document_of(file)["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(primitives[0]["attributes"].size(), 3u);
  EXPECT_TRUE(primitives[0]["attributes"].contains("TEXCOORD_0"));
  EXPECT_EQ(primitives[0]["extras"]["sightcell"], (std::vector<std::uint32_t>{0, 288, 0, 288}));
  EXPECT_EQ(primitives[1]["attributes"].size(), 1u);
  const scene page = load_gltf(file, "p");
  EXPECT_EQ(page.polygon_count, 3u * 2 * sheet::side * sheet::side);
  // Zeros cost less than another primitive.
  const std::size_t alone = pager.page(std::vector<page_part>{{0, all(0)}}).size();
  const std::size_t other = pager.page(std::vector<page_part>{{1, all(1)}}).size();
  EXPECT_LT(pager.page(std::vector<page_part>{{0, all(0)}, {1, all(1)}}).size(), alone + other - 1'200);
}

TEST_F(stream_pages_test, sizes_of_parts_add_up_to_a_page) {
  gltf_sketch g;
  g.add_node({{"mesh", sheet().add_to(g)}});
  const gltf_pager& pager = pager_of(g);
  const page_part part{0, all(0)};
  const double estimate = pager.coded_size(part);
  const double binary = static_cast<double>(pager.page(std::vector<page_part>{part}).size()) - 1'500.0;  // without JSON
  EXPECT_NEAR(estimate, binary, 0.25 * binary);
}

}  // namespace
}  // namespace sightcell::scene
