#include "trace/place_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "hemicube/cpu/cpu_source.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

// Rectangles that overlap in one plane, each in another place of the same size. reversed: the last one comes first.
scene::world_geometry overlapping(bool reversed) {
  test::tiny_scene tiny;
  constexpr int count = 40;
  for (int i = 0; i < count; ++i) {
    const int k = reversed ? count - 1 - i : i;
    const float y = 0.25f * static_cast<float>(k % 8) - 1.5f, z = 0.5f * static_cast<float>(k / 8) - 1.5f;
    tiny.quad({4, y, z + 1}, {4, y, z}, {4, y + 1, z}, {4, y + 1, z + 1}, {scene::alpha_mode::opaque, true});
  }
  return scene::flatten(tiny.finished());
}

std::vector<triangle> in_order(const scene::world_geometry& world) {
  std::vector<std::uint32_t> polygons(world.kinds.size());
  std::iota(polygons.begin(), polygons.end(), 0u);
  sort_by_place(world, polygons);
  std::vector<triangle> found;
  for (const std::uint32_t polygon : polygons) found.push_back(corners_of(world, polygon));
  return found;
}

TEST(place_order, does_not_depend_on_numbers) {
  const scene::world_geometry one = overlapping(false), other = overlapping(true);
  ASSERT_NE(corners_of(one, 0), corners_of(other, 0));
  EXPECT_EQ(in_order(one), in_order(other));
}

TEST(place_order, has_each_polygon_once_and_duplicates_by_number) {
  test::tiny_scene tiny;
  for (const float x : {3.0f, 1.0f, 3.0f, 2.0f, 3.0f}) tiny.triangle({x, 0, 0}, {x, 1, 0}, {x, 0, 1});
  std::vector<std::uint32_t> polygons{4, 0, 2, 1, 3};
  sort_by_place(scene::flatten(tiny.finished()), polygons);
  EXPECT_EQ(polygons, (std::vector<std::uint32_t>{1, 3, 0, 2, 4}));
}

TEST(place_order, of_two_polygons_in_one_place_a_hemicube_shows_the_same_in_any_order) {
  const scene::world_geometry one = overlapping(false), other = overlapping(true);
  hemicube_image of_one, of_other;
  const pose where{{0, 0.1f, 0.2f}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  make_cpu_source(one, {64, 20.0f})->render_image(where, of_one);
  make_cpu_source(other, {64, 20.0f})->render_image(where, of_other);
  ASSERT_EQ(of_one.ids.size(), of_other.ids.size());
  std::size_t shown = 0;
  for (std::size_t i = 0; i < of_one.ids.size(); ++i) {
    ASSERT_EQ(of_one.ids[i] == scene::no_index, of_other.ids[i] == scene::no_index);
    if (of_one.ids[i] == scene::no_index) continue;
    ASSERT_EQ(corners_of(one, of_one.ids[i]), corners_of(other, of_other.ids[i])) << "pixel " << i;
    ++shown;
  }
  EXPECT_GT(shown, 500u);
}

TEST(place_order, of_two_polygons_in_one_place_a_ray_hits_the_same_in_any_order) {
  const scene::world_geometry one = overlapping(false), other = overlapping(true);
  const ray_scene rays_of_one(one, false), rays_of_other(other, false);
  std::size_t hits = 0;
  for (int i = 0; i < 900; ++i) {
    const glm::vec3 to{4.0f, 0.1f * static_cast<float>(i % 30) - 1.45f, 0.1f * static_cast<float>(i / 30) - 1.45f};
    sight a, b;
    rays_of_one.trace({}, glm::normalize(to), a);
    rays_of_other.trace({}, glm::normalize(to), b);
    ASSERT_EQ(a.front == no_polygon, b.front == no_polygon);
    if (a.front == no_polygon) continue;
    ASSERT_EQ(corners_of(one, a.front), corners_of(other, b.front)) << "ray " << i;
    ++hits;
  }
  EXPECT_GT(hits, 500u);
}

}  // namespace
}  // namespace sightcell::bake
