#include "sightcell/scene/alpha_mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

// A 2 x 2 PNG, RGBA, made with a standard encoder: alphas 255 0 / 64 128.
const std::vector<std::uint8_t> png = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x06, 0x00, 0x00, 0x00, 0x72, 0xb6, 0x0d, 0x24, 0x00, 0x00, 0x00,
    0x1d, 0x49, 0x44, 0x41, 0x54, 0x78, 0x01, 0x01, 0x12, 0x00, 0xed, 0xff, 0x00, 0x0a, 0x14, 0x1e, 0xff, 0x01,
    0x02, 0x03, 0x00, 0x00, 0x09, 0x09, 0x09, 0x40, 0x07, 0x07, 0x07, 0x80, 0x14, 0xb2, 0x02, 0x32, 0xcd, 0xac,
    0xbb, 0xc7, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

TEST(alpha_mask, is_exact_at_texel_centers_and_linear_between) {
  const alpha_mask mask{4, 2, {0, 51, 102, 255, 255, 0, 0, 0}, 0.5f};
  EXPECT_FLOAT_EQ(mask.alpha({0.125f, 0.25f}), 0.0f);
  EXPECT_FLOAT_EQ(mask.alpha({0.375f, 0.25f}), 0.2f);
  EXPECT_FLOAT_EQ(mask.alpha({0.5f, 0.25f}), 0.3f);
  EXPECT_FLOAT_EQ(mask.alpha({0.875f, 0.25f}), 1.0f);
  EXPECT_FLOAT_EQ(mask.alpha({0.125f, 0.5f}), 0.5f);
  EXPECT_FLOAT_EQ(mask.alpha({0.5f, 0.5f}), 0.15f);
}

TEST(alpha_mask, repeats) {
  const alpha_mask mask{4, 1, {255, 51, 102, 0}, 0.5f};
  EXPECT_FLOAT_EQ(mask.alpha({0.0f, 0.3f}), 0.5f) << "between the last texel and the first";
  EXPECT_FLOAT_EQ(mask.alpha({1.0f, 0.7f}), 0.5f);
  EXPECT_FLOAT_EQ(mask.alpha({-0.875f, 9.0f}), 1.0f);
  EXPECT_FLOAT_EQ(mask.alpha({3.375f, -2.0f}), 0.2f);
  EXPECT_TRUE(mask.passes({0.0f, 0.0f}));
  EXPECT_FALSE(mask.passes({-0.125f, 0.0f}));
  // Coordinates without a fraction, and the last float below 1, stay inside the texels.
  for (const float u : {1e30f, -1e30f, std::nextafter(1.0f, 0.0f), -1e-30f, 16777217.0f})
    EXPECT_LE(mask.alpha({u, u}), 1.0f) << u;
}

TEST(alpha_mask, clamps_and_mirrors) {
  alpha_mask mask{4, 1, {255, 51, 102, 0}, 0.5f, wrap::clamp};
  EXPECT_FLOAT_EQ(mask.alpha({0.0f, 0.5f}), 1.0f);
  EXPECT_FLOAT_EQ(mask.alpha({-3.0f, 0.5f}), 1.0f);
  EXPECT_FLOAT_EQ(mask.alpha({1.0f, 0.5f}), 0.0f);
  EXPECT_FLOAT_EQ(mask.alpha({7.0f, 0.5f}), 0.0f);
  EXPECT_FLOAT_EQ(mask.alpha({0.5f, 0.5f}), 0.3f);
  mask.wrap_u = wrap::mirror;
  EXPECT_FLOAT_EQ(mask.alpha({0.0f, 0.5f}), 1.0f);
  EXPECT_FLOAT_EQ(mask.alpha({-0.375f, 0.5f}), 0.2f);
  EXPECT_FLOAT_EQ(mask.alpha({1.0f, 0.5f}), 0.0f);
  EXPECT_FLOAT_EQ(mask.alpha({1.625f, 0.5f}), 0.2f);
  EXPECT_FLOAT_EQ(mask.alpha({2.375f, 0.5f}), 0.2f);
  const alpha_mask upright{1, 2, {255, 0}, 0.5f, wrap::repeat, wrap::clamp};
  EXPECT_FLOAT_EQ(upright.alpha({5.0f, -1.0f}), 1.0f);
  EXPECT_FLOAT_EQ(upright.alpha({5.0f, 1.0f}), 0.0f);
  EXPECT_EQ(halved(upright).wrap_v, wrap::clamp);
}

TEST(alpha_mask, halving_takes_means_and_rounds_sizes_up) {
  const alpha_mask half = halved({3, 2, {0, 100, 50, 200, 100, 150}, 0.25f});
  EXPECT_EQ(half.width, 2u);
  EXPECT_EQ(half.height, 1u);
  EXPECT_EQ(half.texels, (std::vector<std::uint8_t>{100, 100}));
  EXPECT_EQ(half.cutoff, 0.25f);
}

scene masked_scene(material m) {
  scene s;
  s.name = "test";
  m.alpha = alpha_mode::mask;
  s.materials = {m};
  geometry g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  g.uvs = {{0, 0}, {1, 0}, {0, 1}};
  g.indices = {0, 1, 2};
  s.geometries = {g};
  draw d;
  d.material = 0;
  s.draws = {d};
  return s;
}

world_geometry flat(scene s) {
  finish(s);
  return flatten(s);
}

scene with_map(float alpha, float cutoff, std::vector<std::uint8_t> texels) {
  material m;
  m.base_color.a = alpha;
  m.alpha_cutoff = cutoff;
  scene s = masked_scene(m);
  const auto width = static_cast<std::uint32_t>(texels.size());
  s.alpha_maps.push_back({width, 1, std::move(texels)});
  s.materials[0].alpha_map = 0;
  return s;
}

TEST(masks, constant_alpha_decides_for_the_whole_polygon) {
  material m;
  m.base_color.a = 0.5f;
  EXPECT_TRUE(flat(masked_scene(m)).kinds[0].occludes());
  EXPECT_FALSE(flat(masked_scene(m)).kinds[0].absent);
  EXPECT_TRUE(flat(masked_scene(m)).masked.empty());
  m.alpha_cutoff = 0.6f;
  EXPECT_TRUE(flat(masked_scene(m)).kinds[0].absent) << "never there";
}

TEST(masks, only_those_that_decide_are_tested) {
  EXPECT_TRUE(flat(with_map(1.0f, 0.5f, {128, 255})).masked.empty());
  EXPECT_FALSE(flat(with_map(1.0f, 0.5f, {128, 255})).kinds[0].absent);
  EXPECT_TRUE(flat(with_map(1.0f, 0.5f, {127, 0})).kinds[0].absent);
  EXPECT_TRUE(flat(with_map(0.0f, 0.5f, {255, 255})).kinds[0].absent);
  const world_geometry w = flat(with_map(0.5f, 0.25f, {127, 128}));
  ASSERT_EQ(w.masked.size(), 1u);
  EXPECT_TRUE(w.kinds[0].alpha_tested);
  EXPECT_EQ(w.masks[0].cutoff, 0.5f) << "of the texel: 0.5 x texel against 0.25";
  EXPECT_EQ(w.masked[0].uvs[1], glm::vec2(1, 0));
}

TEST(masks, alphas_of_colors_are_tested_with_and_without_a_texture) {
  material m;
  m.base_color.a = 0.8f;
  scene s = masked_scene(m);
  s.geometries[0].colors = {glm::u8vec4(255), glm::u8vec4(255), glm::u8vec4(255)};
  EXPECT_TRUE(flat(s).masked.empty()) << "they change nothing";
  s.geometries[0].colors[1].a = 51;
  const world_geometry w = flat(s);
  ASSERT_EQ(w.masked.size(), 1u);
  EXPECT_FLOAT_EQ(w.masked[0].alphas[1], 0.2f);
  EXPECT_FLOAT_EQ(w.masked[0].alphas[2], 1.0f);
  const alpha_mask& mask = w.masks[w.masked[0].mask];
  EXPECT_TRUE(mask.passes({0.3f, 0.3f}, 0.65f)) << "0.65 x 0.8";
  EXPECT_FALSE(mask.passes({0.3f, 0.3f}, 0.6f));
  // Texels that pass everywhere alone do not with a factor.
  scene textured = with_map(1.0f, 0.5f, {128, 255});
  textured.geometries[0].colors = s.geometries[0].colors;
  const world_geometry t = flat(textured);
  ASSERT_EQ(t.masked.size(), 1u);
  EXPECT_EQ(t.masks[t.masked[0].mask].texels, (std::vector<std::uint8_t>{128, 255}));
  s.geometries[0].colors.pop_back();
  EXPECT_THROW(finish(s), error);
}

TEST(masks, mirrored_draws_keep_coordinates_at_their_corners) {
  scene s = with_map(1.0f, 0.5f, {0, 255});
  s.draws[0].to_world[0][0] = -1.0;
  const world_geometry w = flat(s);
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 p = w.positions[w.indices[k]];
    EXPECT_EQ(w.masked[0].uvs[k], glm::vec2(-p.x, p.y)) << k;
  }
}

TEST(masks, missing_and_broken_coordinates_are_those_of_the_origin) {
  scene s = with_map(1.0f, 0.5f, {0, 255});
  s.geometries[0].uvs[1].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(flat(s).masked[0].uvs[1], glm::vec2(0, 0));
  s.geometries[0].uvs.clear();
  EXPECT_EQ(flat(s).masked[0].uvs[2], glm::vec2(0, 0));
}

TEST(masks, alpha_comes_from_the_image_of_the_file) {
  scene s = masked_scene({});
  s.images.push_back({"leaf", png});
  s.materials[0].base_color_image = 0;
  const world_geometry w = flat(s);
  ASSERT_EQ(w.masks.size(), 1u);
  EXPECT_EQ(w.masks[0].texels, (std::vector<std::uint8_t>{255, 0, 64, 128}));
  EXPECT_TRUE(w.warnings.empty());
}

TEST(masks, an_image_that_cannot_be_decoded_is_said_and_left_out) {
  scene s = masked_scene({});
  s.images.push_back({"leaf", std::vector<std::uint8_t>(png.begin(), png.begin() + 40)});
  s.materials[0].base_color_image = 0;
  s.materials.push_back(s.materials[0]);
  const world_geometry w = flat(s);
  EXPECT_TRUE(w.masked.empty());
  EXPECT_TRUE(w.kinds[0].non_occluder && !w.kinds[0].absent) << "nobody knows where its holes are";
  ASSERT_EQ(w.warnings.size(), 1u) << "once for all materials that use it";
  EXPECT_NE(w.warnings[0].find("\"leaf\""), std::string::npos) << w.warnings[0];
}

// 2,048 x 2,048 black pixels of one bit, by zlib at its best: as dense as an honest file gets.
std::vector<std::uint8_t> dense_png() {
  std::vector<std::uint8_t> out = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                                   0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x08, 0x00, 0x00, 0x00, 0x08, 0x00,
                                   0x01, 0x00, 0x00, 0x00, 0x00, 0x9a, 0xdc, 0xee, 0x9d, 0x00, 0x00, 0x02,
                                   0x15, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0xed, 0xc1, 0x31, 0x01, 0x00,
                                   0x00, 0x00, 0xc2, 0xa0, 0xf5, 0x4f, 0xed, 0x6d, 0x07, 0xa0};
  out.resize(out.size() + 510);
  const std::vector<std::uint8_t> end = {0xde, 0x00, 0x08, 0x78, 0x00, 0x01, 0xfa, 0x2d, 0xa6, 0xbb, 0x00,
                                         0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  out.insert(out.end(), end.begin(), end.end());
  return out;
}

// 2,048 x 2,048 gray pixels in two bits per block of 64: the shortest codes that a baseline JPEG has.
std::vector<std::uint8_t> dense_jpeg() {
  std::vector<std::uint8_t> out = {0xFF, 0xD8, 0xFF, 0xDB, 0, 67, 0};
  out.resize(out.size() + 64, 1);
  const auto append = [&out](std::initializer_list<std::uint8_t> bytes) { out.insert(out.end(), bytes); };
  append({0xFF, 0xC0, 0, 11, 8, 8, 0, 8, 0, 1, 1, 0x11, 0});
  for (const std::uint8_t table : {std::uint8_t{0x00}, std::uint8_t{0x10}}) {
    append({0xFF, 0xC4, 0, 20, table, 1});
    out.resize(out.size() + 16);
  }
  append({0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0});
  out.resize(out.size() + 2048 * 2048 / 64 / 4);
  append({0xFF, 0xD9});
  return out;
}

// Files that promise more pixels than their bytes can hold are refused (tests/fuzz has one); these honest ones are not.
TEST(masks, the_densest_images_are_decoded) {
  for (const image& dense : {image{"png", dense_png()}, image{"jpeg", dense_jpeg()}}) {
    const auto pixels = decode(dense, 60000);
    ASSERT_TRUE(pixels) << dense.name;
    EXPECT_EQ(pixels->rgba.size(), std::size_t{4} * 2048 * 2048);
  }
}

TEST(masks, opaque_materials_do_not_decode) {
  scene s = masked_scene({});
  s.images.push_back({"leaf", {1, 2, 3}});
  s.materials[0].base_color_image = 0;
  s.materials[0].alpha = alpha_mode::opaque;
  EXPECT_TRUE(flat(s).warnings.empty());
}

TEST(masks, too_many_texels_are_halved_and_said) {
  scene s = with_map(1.0f, 0.5f, {0, 255});
  constexpr std::uint32_t side = 8448;  // 68 Mi texels
  s.alpha_maps[0] = {side, side, std::vector<std::uint8_t>(std::size_t{side} * side, 255)};
  s.alpha_maps[0].texels[0] = 0;
  const world_geometry w = flat(s);
  ASSERT_EQ(w.masks.size(), 1u);
  EXPECT_EQ(w.masks[0].width, side / 2);
  EXPECT_EQ(w.warnings.size(), 1u);
}

TEST(masks, maps_that_do_not_fit_are_refused) {
  scene s = with_map(1.0f, 0.5f, {0, 255});
  s.alpha_maps[0].height = 2;
  EXPECT_THROW(finish(s), error);
  s = with_map(1.0f, 0.5f, {0, 255});
  s.materials[0].alpha_map = 1;
  EXPECT_THROW(finish(s), error);
}

TEST(masks, the_fingerprint_follows_the_map) {
  scene a = with_map(1.0f, 0.5f, {0, 255}), b = with_map(1.0f, 0.5f, {0, 254});
  finish(a), finish(b);
  EXPECT_NE(a.fingerprint, b.fingerprint);
}

}  // namespace
}  // namespace sightcell::scene
