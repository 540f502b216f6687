#include "casters/visible_shadows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "casters/caster_search.h"
#include "unit/bake/court.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::court;
using test::scene_with_rays;
using ids = std::vector<std::uint32_t>;

constexpr glm::vec3 noon{0.0f, 1.0f, 0.0f};
const std::vector<glm::vec3> eyes{{0.0f, 1.5f, 2.0f}, {-0.4f, 1.3f, 1.6f}, {0.4f, 1.7f, 2.4f}};

caster_sets sets_of(const ids& camera) {
  const auto has = [camera](std::uint32_t polygon) {
    return std::binary_search(camera.begin(), camera.end(), polygon);
  };
  return {has, has};
}

// The polygon nearest to the point on each ray to the light.
ids first_missing(const scene_with_rays& w, const caster_sets& sets, double least_share = 1e-9,
                  const glm::vec3& to_light = noon) {
  const polygon_shadows shadows = shadows_of_polygons(w.rays, to_light, [] { return true; });
  std::uint64_t rays = 0;
  ids found;
  for (const missed_shadow& one :
       missed_shadows_of_polygons(w.rays, shadows, sets, eyes, {1, 3, purpose::caster_search, 1}, least_share, rays)) {
    EXPECT_FALSE(one.lacking.one_of.empty());
    EXPECT_EQ(one.to_light, to_light);
    found.push_back(one.lacking.one_of.front());
  }
  EXPECT_GE(rays, found.size());
  std::sort(found.begin(), found.end());
  return found;
}

TEST(polygon_shadows, has_what_the_shadow_of_each_point_falls_on) {
  court c;
  const std::uint32_t glass =
      c.tiny.quad({-3, 12, -4}, {3, 12, -4}, {3, 12, -8}, {-3, 12, -8}, {scene::alpha_mode::blend, true});
  const scene_with_rays w(c.tiny);
  const polygon_shadows shadows = shadows_of_polygons(w.rays, noon, [] { return true; });
  const auto receiver = [&](std::uint32_t polygon, std::size_t point) {
    return shadows.receivers[shadow_points * polygon + point];
  };
  for (std::size_t point = 0; point < shadow_points; ++point) {
    for (const std::uint32_t roof : {c.near_roof, c.far_roof + 1})
      EXPECT_TRUE(receiver(roof, point) == c.floor || receiver(roof, point) == c.floor + 1) << point;
    EXPECT_EQ(receiver(c.unseen_roof, point), no_polygon) << "beside the floor";
    EXPECT_EQ(receiver(glass, point), no_polygon) << "casts no shadow";
  }
}

TEST(polygon_shadows, ends_when_it_is_told) {
  const court c;
  const scene_with_rays w(c.tiny);
  const polygon_shadows none = shadows_of_polygons(w.rays, noon, [] { return false; });
  EXPECT_EQ(none.receivers, ids(shadow_points * w.rays.geometry().kinds.size(), no_polygon));
}

TEST(visible_shadows, finds_casters_whose_shadow_is_visible) {
  const court c;
  const scene_with_rays w(c.tiny);
  EXPECT_EQ(first_missing(w, sets_of(c.camera)), (ids{c.near_roof, c.near_roof + 1, c.far_roof, c.far_roof + 1}));
  EXPECT_EQ(first_missing(w, sets_of({c.wall, c.wall + 1})), ids{}) << "the host does not draw the floor";
}

TEST(visible_shadows, leaves_out_what_the_set_replaces_and_what_is_hardly_visible) {
  court c;
  const scene_with_rays w(c.tiny);
  caster_sets with_roof = sets_of(c.camera);
  with_roof.drawn = [&](std::uint32_t polygon) { return polygon == c.near_roof || with_roof.camera(polygon); };
  EXPECT_EQ(first_missing(w, with_roof), (ids{c.near_roof + 1, c.far_roof, c.far_roof + 1}));
  // The part around a point fills about 7e-4 of the directions in the shadow of the near roof, 1.3e-4 in that of the
  // far.
  EXPECT_EQ(first_missing(w, sets_of(c.camera), 3e-4), (ids{c.near_roof, c.near_roof + 1}));
  EXPECT_EQ(first_missing(w, sets_of(c.camera), 0.01), ids{});
}

// A card that no random ray of a search meets.
TEST(visible_shadows, are_tried_in_the_search_of_a_cell) {
  court c;
  const std::uint32_t card =
      c.tiny.quad({6.0f, 3.0f, -3.0f}, {6.06f, 3.0f, -3.0f}, {6.06f, 3.0f, -3.06f}, {6.0f, 3.0f, -3.06f});
  const scene_with_rays w(c.tiny);
  const viewpoint_region cell{{-0.5f, 1.2f, 1.5f}, {0.5f, 1.8f, 2.5f}};
  const polygon_shadows shadows = shadows_of_polygons(w.rays, noon, [] { return true; });
  const auto casters = [&](const polygon_shadows* tried) {
    return find_casters(w.rays, nullptr, tried, {.region = cell, .valid_share = 1.0, .place = 3, .camera = c.camera},
                        {noon, noon}, {.max_error = 1e-3})
        .casters;
  };
  const auto has_card = [&](const ids& found) { return std::binary_search(found.begin(), found.end(), card); };
  EXPECT_FALSE(has_card(casters(nullptr)));
  EXPECT_TRUE(has_card(casters(&shadows)));
}

}  // namespace
}  // namespace sightcell::bake
