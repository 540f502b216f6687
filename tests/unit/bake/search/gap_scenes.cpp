#include "unit/bake/search/gap_scenes.h"

#include <array>
#include <glm/vec3.hpp>

#include "sightcell/base/random.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {
namespace {

bake::random_stream numbers_of(std::uint64_t variant) {
  return bake::random_stream(variant, 7, bake::purpose::verify);
}

// A rectangle at x = place that faces -x.
std::uint32_t facing_cell(tiny_scene& made, float place, float y0, float y1, float z0, float z1) {
  return made.quad({place, y0, z0}, {place, y0, z1}, {place, y1, z1}, {place, y1, z0});
}

// A wall that faces -x with a rectangular hole.
void wall_with_hole(tiny_scene& made, float place, float y0, float y1, float z0, float z1) {
  facing_cell(made, place, -30, y0, -60, 60);
  facing_cell(made, place, y1, 30, -60, 60);
  facing_cell(made, place, y0, y1, -60, z0);
  facing_cell(made, place, y0, y1, z1, 60);
}

std::vector<std::uint32_t> both_of(std::uint32_t first) {
  return {first, first + 1};
}

const bake::box long_cell{{0, 0, 0}, {4, 2, 12}};

}  // namespace

gap_scene slit(std::uint64_t variant) {
  auto random = numbers_of(variant);
  tiny_scene made;
  made.closed_box({-60, -30, -60}, {60, 30, 60}, true);
  const float z = 0.5f + 10.7f * random.uniform();
  facing_cell(made, 4.6f, -30, 30, -60, z);
  facing_cell(made, 4.6f, -30, 30, z + 0.3f, 60);
  const auto hidden = facing_cell(made, 12.6f, -30, 30, z, z + 0.3f);
  return {made.finished(), long_cell, both_of(hidden), {}};
}

gap_scene window(std::uint64_t variant) {
  auto random = numbers_of(variant);
  tiny_scene made;
  made.closed_box({-60, -30, -60}, {60, 30, 60}, true);
  const float z = 8.5f + 2.3f * random.uniform(), y = 0.1f + 1.1f * random.uniform();
  wall_with_hole(made, 4.6f, y, y + 0.7f, z, z + 0.7f);
  const auto hidden = facing_cell(made, 12.6f, y + 0.2f, y + 0.5f, z + 0.2f, z + 0.5f);
  return {made.finished(), long_cell, both_of(hidden), {}};
}

gap_scene crack(std::uint64_t variant) {
  auto random = numbers_of(variant);
  tiny_scene made;
  made.closed_box({-60, -30, -60}, {60, 30, 60}, true);
  const float z = 9.0f + 2.0f * random.uniform();
  made.closed_box({4.6f, -30, -59}, {5.4f, 30, z});
  made.closed_box({4.6f, -30, z + 0.25f}, {5.4f, 30, 59});
  const auto hidden = facing_cell(made, 8.0f, -30, 30, z, z + 0.25f);
  return {made.finished(), long_cell, both_of(hidden), {}};
}

namespace {

// A wall of large tiles that faces -x with a small one at (y, z) between them. Returns the small one.
std::uint32_t wall_with_tile(tiny_scene& made, float place, float y, float z, float size) {
  const std::array<float, 4> ys{-30, y, y + size, 30}, zs{-60, z, z + size, 60};
  std::uint32_t tile = 0;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      const auto first = facing_cell(made, place, ys[row], ys[row + 1], zs[column], zs[column + 1]);
      if (row == 1 && column == 1) tile = first;
    }
  return tile;
}

}  // namespace

gap_scene tile_behind_window(std::uint64_t variant) {
  auto random = numbers_of(variant);
  tiny_scene made;
  made.closed_box({-60, -30, -60}, {80, 30, 60}, true);
  const float z = 4.0f + 3.5f * random.uniform(), y = 0.5f + random.uniform();
  wall_with_hole(made, 8.0f, y, y + 0.5f, z, z + 0.5f);
  const auto hidden = wall_with_tile(made, 8.2f, y + 0.2f, z + 0.1f + 0.3f * random.uniform(), 0.03f);
  return {made.finished(), {{0, 0, 4}, {4, 2, 8}}, both_of(hidden), {}};
}

gap_scene corridor(std::uint64_t variant) {
  auto random = numbers_of(variant);
  tiny_scene made;
  made.closed_box({-1, -1, -1}, {67, 4, 5}, true);
  const float y = 0.4f + random.uniform(), z = 0.4f + 3.0f * random.uniform();
  wall_with_hole(made, 64.5f, y, y + 0.3f, z, z + 0.3f);
  const auto hidden = facing_cell(made, 65.0f, y + 0.05f, y + 0.25f, z + 0.05f, z + 0.25f);
  gap_scene found{made.finished(), {{0, 0, 0}, {4, 2, 4}}, both_of(hidden), {}};
  for (int i = 1; i < 16; ++i) {
    const float x = 4.0f * static_cast<float>(i);
    found.beside.push_back({{x, 0, 0}, {x + 4, 2, 4}});
  }
  return found;
}

gap_scene tile_behind_plate(std::uint64_t variant) {
  auto random = numbers_of(variant);
  tiny_scene made;
  made.closed_box({-60, -30, -60}, {60, 30, 60}, true);
  // The tile is seen from places with z > 3.9 alone: the plate ends at one eighth of the way from the tile to there.
  const float y = 0.5f + random.uniform(), z = 1.0f + 2.0f * random.uniform(), end = z + (3.9f - z) / 8.0f;
  facing_cell(made, 11.0f, -2, 4, z - 1.0f, end);
  const auto hidden = wall_with_tile(made, 12.0f, y, z, 0.03f);
  return {made.finished(), {{0, 0, 0}, {4, 2, 4}}, both_of(hidden), {}};
}

}  // namespace sightcell::test
