#include "sightcell/scene/texture_uses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image_header.h"
#include "sightcell/scene/scene.h"
#include "unit/scene/gltf_sketch.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

std::string big_u32(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xFFu);
  return out;
}

// The begin of a PNG.
std::string png_header(std::uint32_t width, std::uint32_t height) {
  return std::string("\x89PNG\r\n\x1A\n", 8) + big_u32(13) + "IHDR" + big_u32(width) + big_u32(height) +
         std::string("\x08\x06\0\0\0", 5) + std::string(12, '\0');
}

std::optional<image_size> size_in(const std::string& text) {
  return size_in_header({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void expect_size(const std::string& text, std::uint32_t width, std::uint32_t height) {
  const auto size = size_in(text);
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, width);
  EXPECT_EQ(size->height, height);
}

TEST(image_header, has_the_size_in_every_format) {
  const std::string rest(40, '\0');
  expect_size(png_header(300, 20), 300, 20);
  expect_size("\xABKTX 20\xBB\r\n\x1A\n" + u32_text(0) + u32_text(1) + u32_text(512) + u32_text(64) + rest, 512, 64);
  expect_size("DDS " + u32_text(124) + u32_text(7) + u32_text(64) + u32_text(512) + rest, 512, 64);
  const std::string riff = "RIFF" + u32_text(100) + "WEBP";
  expect_size(riff + "VP8X" + u32_text(10) + u32_text(0) + std::string("\xFF\x01\0\x3F\0\0", 6) + rest, 512, 64);
  expect_size(riff + "VP8L" + u32_text(10) + "\x2F" + u32_text(511u | 63u << 14) + rest, 512, 64);
  expect_size(riff + "VP8 " + u32_text(10) + std::string(3, '\0') + std::string("\x9D\x01\x2A", 3) +
                  std::string("\0\x42\x40\0", 4) + rest,
              512, 64);
  EXPECT_FALSE(size_in(""));
  EXPECT_FALSE(size_in("RIFF" + rest));
  EXPECT_FALSE(size_in("DDS " + rest)) << "no texel";
  EXPECT_FALSE(size_in("DDS "));
}

// A triangle with two sets of coordinates, a material that a test completes, and three images.
struct textured {
  gltf_sketch g;
  temporary_folder folder;

  textured() {
    const int positions = g.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int first = g.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2", 5126, 3);
    const int second = g.add_accessor(std::vector<float>{5, 5, 6, 5, 5, 6}, "VEC2", 5126, 3);
    g.json["meshes"] = {{{"primitives",
                          {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", first}, {"TEXCOORD_1", second}}},
                            {"material", 0}}}}}};
    g.json["nodes"] = {{{"mesh", 0}}};
    g.json["materials"] = json::array({json::object()});
    g.json["textures"] = {{{"source", 2}}, {{"source", 0}}, {{"source", 1}}};
    for (int i = 0; i < 3; ++i) {
      const std::string name = "image" + std::to_string(i) + ".png";
      folder.write(name, png_header(64u << i, 32));
      g.json["images"].push_back({{"uri", name}});
    }
  }
  texture_uses read() {
    const auto path = folder.write("textured.glb", g.glb());
    return read_texture_uses(path, load_gltf(path));
  }
};

TEST(texture_uses, are_all_textures_of_drawn_materials) {
  textured t;
  const json transform = {{"scale", {4, 2}}, {"rotation", 0.5}, {"texCoord", 0}};
  t.g.json["materials"][0] = {
      {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
      {"normalTexture", {{"index", 1}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", transform}}}}},
      {"extensions", {{"KHR_materials_clearcoat", {{"clearcoatTexture", {{"index", 0}, {"texCoord", 1}}}}}}},
      {"extras", {{"someTexture", {{"index", 2}}}}}};
  t.g.json["materials"].push_back({{"emissiveTexture", {{"index", 2}}}});  // of no draw
  const texture_uses uses = t.read();
  EXPECT_TRUE(uses.warnings.empty());
  ASSERT_EQ(uses.textures.size(), 2u);
  EXPECT_EQ(uses.textures[0].image, 0u);
  EXPECT_EQ(uses.textures[0].width, 64u);
  EXPECT_EQ(uses.textures[0].height, 32u);
  EXPECT_EQ(uses.textures[1].image, 2u);
  EXPECT_EQ(uses.textures[1].width, 256u);
  ASSERT_EQ(uses.of_material.size(), 2u);
  EXPECT_TRUE(uses.of_material[1].empty());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  for (const texture_use& use : uses.of_material[0]) {
    found.emplace_back(use.texture, use.set);
    // The matrix of the extension: rotation times scale.
    const glm::dmat2 moved(4 * std::cos(0.5), -4 * std::sin(0.5), 2 * std::sin(0.5), 2 * std::cos(0.5));
    EXPECT_EQ(use.transform, use.texture == 0 ? moved : glm::dmat2(1.0));
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 0}, {1, 0}, {1, 1}}));
  const auto& sets = uses.coordinates.at({0, 0});
  EXPECT_EQ(sets.at(0), (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(sets.at(1), (std::vector<glm::vec2>{{5, 5}, {6, 5}, {5, 6}}));
}

TEST(texture_uses, leave_out_images_of_unknown_size) {
  textured t;
  t.g.json["materials"][0] = {{"normalTexture", {{"index", 0}, {"texCoord", 7}}}, {"emissiveTexture", {{"index", 1}}}};
  t.folder.write("image0.png", "no image");
  const texture_uses uses = t.read();
  ASSERT_EQ(uses.textures.size(), 1u);
  EXPECT_EQ(uses.textures[0].image, 2u);
  ASSERT_EQ(uses.warnings.size(), 1u);
  EXPECT_NE(uses.warnings[0].find("images[0]"), std::string::npos) << uses.warnings[0];
  EXPECT_TRUE(uses.coordinates.at({0, 0}).at(7).empty()) << "the primitive has no such set";
}

TEST(texture_uses, have_the_images_that_extensions_name) {
  textured t;
  t.g.json["textures"][0] = {{"source", 1}, {"extensions", {{"KHR_texture_basisu", {{"source", 2}}}}}};
  t.g.json["materials"][0] = {{"normalTexture", {{"index", 0}}}};
  const texture_uses uses = t.read();
  ASSERT_EQ(uses.textures.size(), 2u);
  EXPECT_EQ(uses.textures[0].image, 1u);
  EXPECT_EQ(uses.textures[1].image, 2u);
}

}  // namespace
}  // namespace sightcell::scene
