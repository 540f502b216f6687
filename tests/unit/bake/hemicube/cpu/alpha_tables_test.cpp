// The tables of alpha tests give the same result as alpha_mask: thresholds, quads and block counts.
#define HWY_COMPILE_ONLY_SCALAR  // as in the portable kernel
#include "hemicube/cpu/alpha_tables.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "hemicube/cpu/alpha_test.h"

namespace {

namespace cpu = sightcell::bake::cpu;
namespace scene = sightcell::scene;

// Smooth spots, so that there are blocks that pass, that fail, and others.
scene::alpha_mask spots(std::uint32_t width, std::uint32_t height, scene::wrap u, scene::wrap v) {
  scene::alpha_mask mask{width, height, {}, 0.5f, u, v};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      mask.texels.push_back(
          static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * std::sin(x * 0.3) * std::cos(y * 0.2))));
  return mask;
}

scene::masked_polygon polygon_of(std::uint32_t mask, std::array<glm::vec2, 3> uvs, float alpha = 1.0f) {
  scene::masked_polygon p;
  p.mask = mask;
  p.uvs = uvs;
  p.alphas = {alpha, alpha, alpha};
  return p;
}

constexpr cpu::tile_bits every_pixel = ~cpu::tile_bits{0};

TEST(alpha_tables, a_threshold_is_the_smallest_number_that_passes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> part(0.0f, 1.2f);
  scene::world_geometry world;
  for (std::uint32_t i = 0; i < 100; ++i) {
    world.masks.push_back(spots(4, 4, scene::wrap::repeat, scene::wrap::repeat));
    world.masks.back().cutoff = i == 0 ? 0.0f : part(random);
    world.masked.push_back(polygon_of(i, {}, i < 50 ? 1.0f : part(random)));
  }
  const cpu::alpha_tables tables(world);
  ASSERT_EQ(tables.tests.size(), 100u);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const float t = tables.tests[i].threshold, alpha = world.masked[i].alphas[0], cutoff = world.masks[i].cutoff;
    EXPECT_GE(t / 255.0f * alpha, cutoff) << i;
    const float below = std::isinf(t) ? 256.0f : std::nextafter(t, 0.0f);  // 256: more than any lookup returns
    EXPECT_TRUE(t == 0.0f || below / 255.0f * alpha < cutoff) << i;
  }
}

TEST(alpha_tables, polygons_with_one_mask_and_alpha_share_a_test) {
  scene::world_geometry world;
  world.masks.push_back(spots(8, 8, scene::wrap::repeat, scene::wrap::repeat));
  for (const float alpha : {1.0f, 0.5f, 1.0f, 0.5f}) world.masked.push_back(polygon_of(0, {}, alpha));
  world.masked.push_back(polygon_of(0, {}));
  world.masked.back().alphas[2] = 0.25f;
  const cpu::alpha_tables tables(world);
  ASSERT_EQ(tables.tests.size(), 3u);
  EXPECT_EQ(tables.triangles[0].test, tables.triangles[2].test);
  EXPECT_EQ(tables.triangles[1].test, tables.triangles[3].test);
  EXPECT_TRUE(tables.tests[tables.triangles[4].test].varies);
  EXPECT_FALSE(tables.tests[tables.triangles[0].test].varies);
}

TEST(alpha_tables, many_alphas_on_a_large_mask_do_not_fill_the_memory) {
  constexpr std::uint32_t side = 4096, counted = 16;  // 2^28 texels
  scene::world_geometry world;
  world.masks.push_back({side, side, std::vector<std::uint8_t>(std::size_t{side} * side), 0.5f});
  for (std::uint32_t i = 0; i < counted + 4; ++i)
    world.masked.push_back(polygon_of(0, {}, 1.0f - static_cast<float>(i) / 64.0f));
  const cpu::alpha_tables tables(world);
  ASSERT_EQ(tables.tests.size(), counted + 4);
  const cpu::scene_view view{
      {}, {}, {}, tables.triangles.data(), tables.tests.data(), tables.texels.data(), tables.counts.data()};
  const cpu::alpha_planes inside{{0.0, 0.0, 1.0}, {0.0, 0.0, 0.5}, {0.0, 0.0, 0.5}, {}};
  for (std::uint32_t i = 0; i < counted + 4; ++i) {
    EXPECT_EQ(cpu::known_between(view, tables.triangles[i], inside, 0, 0, 7, 7),
              i < counted ? cpu::alpha_result::fails : cpu::alpha_result::unknown);
    EXPECT_EQ(cpu::alpha_passes(view, tables.tests[i], cpu::tile_of(inside, 0, 0), every_pixel), 0u);
  }
}

// A triangle on the image, in perspective, with pixels to test.
struct placed {
  cpu::alpha_planes planes;
  std::uint32_t x = 0, y = 0;
};

placed random_placed(std::mt19937& random, const cpu::masked_triangle& t, bool varies) {
  std::uniform_real_distribution<double> wide(-1.0, 1.0);
  const cpu::corner3 corners[3] = {{wide(random) - 1.0, wide(random) - 1.0, 2.0 + wide(random)},
                                   {wide(random) + 1.0, wide(random) - 1.0, 2.0 + wide(random)},
                                   {wide(random), wide(random) + 1.0, 2.0 + wide(random)}};
  cpu::face_frame face{};
  face.half = 64.0f;
  face.center_x = face.center_y = 64;
  return {cpu::planes_of(face, t, varies, corners), static_cast<std::uint32_t>(random() % 16 * 8),
          static_cast<std::uint32_t>(random() % 16 * 8)};
}

// Returns the texture coordinates of a pixel, or NaN where the triangle is seen edge-on.
glm::vec2 coordinates(const cpu::alpha_planes& p, std::uint32_t x, std::uint32_t y) {
  const double weight = cpu::at(p.weight, x + 0.5, y + 0.5);
  return {static_cast<float>(cpu::at(p.u, x + 0.5, y + 0.5) / weight),
          static_cast<float>(cpu::at(p.v, x + 0.5, y + 0.5) / weight)};
}

TEST(alpha_tables, lookups_and_block_counts_agree_with_the_mask) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> anywhere(-3.0f, 3.0f);
  std::size_t pixels = 0, different = 0, passed = 0, failed = 0, passed_pixels = 0;
  for (const scene::wrap u : {scene::wrap::repeat, scene::wrap::mirror, scene::wrap::clamp})
    for (const scene::wrap v : {scene::wrap::repeat, scene::wrap::mirror, scene::wrap::clamp})
      for (const auto& [width, height] : {std::pair{64u, 96u}, {1u, 1u}, {5u, 33u}}) {
        scene::world_geometry world;
        world.masks.push_back(spots(width, height, u, v));
        for (int i = 0; i < 40; ++i) {
          const glm::vec2 at{anywhere(random), anywhere(random)};
          const float size = i % 2 == 0 ? 0.3f : 1.0f;
          world.masked.push_back(polygon_of(0,
                                            {at, at + size * glm::vec2(anywhere(random), anywhere(random)),
                                             at + size * glm::vec2(anywhere(random), anywhere(random))},
                                            i % 4 == 0 ? 0.7f : 1.0f));
        }
        const cpu::alpha_tables tables(world);
        const cpu::scene_view view{
            {}, {}, {}, tables.triangles.data(), tables.tests.data(), tables.texels.data(), tables.counts.data()};
        for (std::size_t i = 0; i < world.masked.size(); ++i) {
          const cpu::masked_triangle& t = tables.triangles[i];
          const cpu::alpha_test& test = tables.tests[t.test];
          const placed tile = random_placed(random, t, false);
          const cpu::alpha_tile planes = cpu::tile_of(tile.planes, tile.x, tile.y);
          const cpu::tile_bits passing = cpu::alpha_passes(view, test, planes, every_pixel);
          const cpu::tile_bits some = cpu::tile_bits{random()} << 32 | random();
          ASSERT_EQ(cpu::alpha_passes(view, test, planes, some), passing & some);
          const auto known = cpu::known_between(view, t, tile.planes, tile.x, tile.y, tile.x + 7, tile.y + 7);
          passed += known == cpu::alpha_result::passes ? 1u : 0u;
          failed += known == cpu::alpha_result::fails ? 1u : 0u;
          for (std::uint32_t j = 0; j < 8; ++j) {
            const std::uint32_t bits = cpu::row_of(passing, j);
            const bool agrees =
                known == cpu::alpha_result::unknown || bits == (known == cpu::alpha_result::passes ? 0xFFu : 0u);
            ASSERT_TRUE(agrees) << "triangle " << i << ", row " << j;
            for (std::uint32_t k = 0; k < 8; ++k) {
              const glm::vec2 uv = coordinates(tile.planes, tile.x + k, tile.y + j);
              if (!(std::abs(uv.x) < 100.0f && std::abs(uv.y) < 100.0f)) continue;
              const bool passes = (bits >> k & 1u) != 0;
              ++pixels;
              passed_pixels += passes ? 1u : 0u;
              different += world.masks[0].passes(uv, world.masked[i].alphas[0]) == passes ? 0u : 1u;
            }
          }
        }
      }
  // Coordinates are rounded differently.
  EXPECT_GT(pixels, 60000u);
  EXPECT_GT(passed_pixels, pixels / 5);
  EXPECT_LT(different, pixels / 2000);
  EXPECT_GT(passed, 50u);
  EXPECT_GT(failed, 50u);
}

TEST(alpha_tables, a_tile_on_the_horizon_of_a_triangle_is_unknown) {
  scene::world_geometry world;
  world.masks.push_back(spots(64, 64, scene::wrap::clamp, scene::wrap::clamp));
  for (std::uint8_t& texel : world.masks[0].texels) texel = 0;
  world.masked.push_back(polygon_of(0, {glm::vec2{0, 0}, glm::vec2{1, 0}, glm::vec2{0, 1}}));
  const cpu::alpha_tables tables(world);
  const cpu::scene_view view{
      {}, {}, {}, tables.triangles.data(), tables.tests.data(), tables.texels.data(), tables.counts.data()};
  // The weight is 0 in the middle of the tile at (0, 0), and 8 in that of the tile at (8, 0).
  const cpu::alpha_planes planes{{1.0, 0.0, -4.0}, {0.0, 0.0, 0.1}, {0.0, 0.0, 0.1}, {}};
  EXPECT_EQ(cpu::known_between(view, tables.triangles[0], planes, 0, 0, 7, 7), cpu::alpha_result::unknown);
  EXPECT_EQ(cpu::known_between(view, tables.triangles[0], planes, 8, 0, 15, 7), cpu::alpha_result::fails);
}

}  // namespace
