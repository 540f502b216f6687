// An opacity map never contradicts the alpha test, and it knows most of a mask with large areas.
#include "sightcell/scene/opacity_maps.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "sightcell/scene/alpha_mask.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

bool passes(const masked_polygon& p, const alpha_mask& mask, float u, float v) {
  const glm::vec2 uv = p.uvs[0] + (p.uvs[1] - p.uvs[0]) * u + (p.uvs[2] - p.uvs[0]) * v;
  const float alpha = p.alphas[0] + (p.alphas[1] - p.alphas[0]) * u + (p.alphas[2] - p.alphas[0]) * v;
  return mask.passes(uv, alpha);
}

// A mask of squares that are opaque or not, with some texels between.
alpha_mask made_of_squares(std::mt19937& random, std::uint32_t width, std::uint32_t height, std::uint32_t square) {
  alpha_mask mask{width, height, {}, 0.5f};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t kind = (x / square * 7 + y / square * 13) % 3;
      mask.texels.push_back(static_cast<std::uint8_t>(kind == 0 ? 0 : kind == 1 ? 255 : random() % 256));
    }
  return mask;
}

masked_polygon covering(glm::vec2 from, glm::vec2 to) {
  masked_polygon p;
  p.uvs = {from, glm::vec2{to.x, from.y}, glm::vec2{from.x, to.y}};
  return p;
}

alpha_mask half_opaque(std::uint32_t size) {
  alpha_mask mask{size, size, {}, 0.5f};
  for (std::uint32_t i = 0; i < size * size; ++i) mask.texels.push_back(i % size < size / 2 ? 255 : 0);
  return mask;
}

TEST(opacity_maps, never_contradict_the_alpha_test) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<alpha_mask> masks;
  for (const wrap u : {wrap::repeat, wrap::clamp, wrap::mirror})
    for (const wrap v : {wrap::repeat, wrap::clamp, wrap::mirror})
      for (const float cutoff : {0.1f, 0.5f, 128.0f / 255.0f, 0.9f}) {
        masks.push_back(made_of_squares(random, 64, 48, 12));
        masks.back().wrap_u = u, masks.back().wrap_v = v, masks.back().cutoff = cutoff;
      }
  std::vector<masked_polygon> polygons;
  for (std::uint32_t mask = 0; mask < masks.size(); ++mask)
    for (const float size : {0.05f, 0.3f, 1.0f, 2.5f}) {
      masked_polygon p;
      p.mask = mask;
      const glm::vec2 from{6.0f * unit(random) - 3.0f, 6.0f * unit(random) - 3.0f};
      for (glm::vec2& uv : p.uvs) uv = from + size * glm::vec2{unit(random), unit(random)};
      if (mask % 2 == 1) p.alphas = {0.8f, 0.8f, 0.8f};
      polygons.push_back(p);
    }
  const opacity_maps maps = make_opacity_maps(polygons, masks);
  std::size_t known = 0, points = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i)
    for (int k = 0; k < 2'000; ++k) {
      float u = unit(random), v = unit(random);
      if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
      const opacity at = maps.at(i, u, v);
      ++points;
      if (at == opacity::unknown) continue;
      ++known;
      ASSERT_EQ(at == opacity::passes, passes(polygons[i], masks[polygons[i].mask], u, v))
          << "polygon " << i << " at " << u << ", " << v;
    }
  EXPECT_GT(known, points / 10);
}

TEST(opacity_maps, know_whole_polygons_and_most_parts_of_others) {
  const std::vector<alpha_mask> masks{half_opaque(256)};
  const std::vector<masked_polygon> polygons{covering({0.1f, 0.1f}, {0.4f, 0.9f}), covering({0.6f, 0.1f}, {0.9f, 0.9f}),
                                             covering({0.1f, 0.1f}, {0.9f, 0.9f})};
  const opacity_maps maps = make_opacity_maps(polygons, masks);
  EXPECT_EQ(maps.whole(0), opacity::passes);
  EXPECT_EQ(maps.whole(1), opacity::fails);
  EXPECT_EQ(maps.whole(2), opacity::unknown);
  EXPECT_EQ(maps.at(2, 0.1f, 0.1f), opacity::passes);
  EXPECT_EQ(maps.at(2, 0.8f, 0.1f), opacity::fails);
  EXPECT_EQ(maps.at(2, 0.5f, 0.1f), opacity::unknown);
  int unknown = 0;
  for (int i = 0; i < 1000; ++i) unknown += maps.at(2, static_cast<float>(i) * 1e-3f, 0.0f) == opacity::unknown;
  EXPECT_LT(unknown, 100);
}

TEST(opacity_maps, polygons_with_the_same_coordinates_share_a_map) {
  const std::vector<alpha_mask> masks{half_opaque(64), half_opaque(64)};
  std::vector<masked_polygon> polygons(100, covering({0.0f, 0.0f}, {1.0f, 1.0f}));
  polygons[50].mask = 1;
  const opacity_maps maps = make_opacity_maps(polygons, masks);
  EXPECT_EQ(maps.maps.size(), 2u);
  EXPECT_EQ(maps.map_of[0], maps.map_of[99]);
  EXPECT_NE(maps.map_of[0], maps.map_of[50]);
}

TEST(opacity_maps, nothing_is_known_outside_of_a_polygon_or_where_vertex_alphas_differ) {
  const std::vector<alpha_mask> masks{half_opaque(64)};
  std::vector<masked_polygon> polygons(2, covering({0.1f, 0.1f}, {0.4f, 0.4f}));
  polygons[1].alphas = {1.0f, 0.9f, 1.0f};
  const opacity_maps maps = make_opacity_maps(polygons, masks);
  EXPECT_EQ(maps.at(0, 0.3f, 0.3f), opacity::passes);
  EXPECT_EQ(maps.at(1, 0.3f, 0.3f), opacity::unknown);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const auto& [u, v] :
       {std::pair{-1e-6f, 0.5f}, {0.5f, -1e-6f}, {0.6f, 0.5f}, {nan, 0.1f}, {0.1f, nan}, {infinity, 0.0f}})
    EXPECT_EQ(maps.at(0, u, v), opacity::unknown) << u << ", " << v;
  EXPECT_EQ(opacity_maps().at(5, 0.3f, 0.3f), opacity::unknown);
}

TEST(opacity_maps, coordinates_far_away_are_unknown_and_many_maps_become_coarser) {
  const std::vector<alpha_mask> masks{half_opaque(256)};
  std::vector<masked_polygon> polygons{covering({1e30f, -1e30f}, {2e30f, 1e30f}), covering({1e7f, 0.0f}, {1e7f, 0.1f})};
  for (int i = 0; i < 20'000; ++i) {
    const float from = 1e-4f * static_cast<float>(i);
    polygons.push_back(covering({from, 0.0f}, {from + 1.0f, 1.0f}));
  }
  const opacity_maps maps = make_opacity_maps(polygons, masks);
  EXPECT_EQ(maps.at(0, 0.3f, 0.3f), opacity::unknown);
  EXPECT_EQ(maps.at(1, 0.3f, 0.3f), opacity::unknown);
  EXPECT_LE(maps.parts.size(), std::size_t{1} << 25);
  EXPECT_GT(maps.parts.size(), std::size_t{1} << 22);
}

}  // namespace
}  // namespace sightcell::scene
