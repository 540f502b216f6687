#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "unit/bake/hemicube/all_sources.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using namespace sightcell::test;
using look = tiny_scene::look;

constexpr std::uint32_t size = source_test_size;
const look pane{scene::alpha_mode::blend, false}, turned_pane{scene::alpha_mode::blend, true};
const look both_sides{scene::alpha_mode::opaque, true};

TEST_P(source_test, an_empty_scene_shows_nothing) {
  tiny_scene s;
  const auto view = look_at(s);
  EXPECT_TRUE(view.seen.empty());
  for (const double i : view.importance) EXPECT_EQ(i, 0.0);
}

TEST_P(source_test, a_quad_hides_another) {
  tiny_scene s;
  const auto far_wall = s.wall_x(4, -1, 1);
  const auto near_wall = s.wall_x(2, -1, 1);
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, near_wall));
  EXPECT_FALSE(sees_wall(view, far_wall));
}

TEST_P(source_test, a_larger_wall_behind_is_seen_around_the_edges) {
  tiny_scene s;
  const auto near_wall = s.wall_x(2, -1, 1);
  const auto far_wall = s.wall_x(4, -1, 3);
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, near_wall));
  EXPECT_TRUE(sees_wall(view, far_wall));
  // 1 / 2 of the front image's width, and 3 / 4 of it less that.
  EXPECT_EQ(pixels_of(view, near_wall) + pixels_of(view, near_wall + 1), 32u * 32u);
  EXPECT_EQ(pixels_of(view, far_wall) + pixels_of(view, far_wall + 1), 48u * 48u - 32u * 32u);
}

TEST_P(source_test, single_sided_walls_from_behind_are_not_seen_and_hide_nothing) {
  tiny_scene s;
  const auto turned = s.wall_x(2, 1, 2);
  const auto behind = s.wall_x(4, -1, 1);
  const auto view = look_at(s);
  EXPECT_FALSE(sees_wall(view, turned));
  EXPECT_TRUE(sees_wall(view, behind));
}

TEST_P(source_test, double_sided_walls_are_seen_and_hide_from_behind) {
  tiny_scene s;
  const auto turned = s.wall_x(2, 1, 2, both_sides);
  const auto behind = s.wall_x(4, -1, 1);
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, turned));
  EXPECT_FALSE(sees_wall(view, behind));
}

TEST_P(source_test, a_mirrored_draw_keeps_its_front) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(2, -1, 1);
  scene::scene s = tiny.finished();
  s.draws[0].to_world[2][2] = -1.0;
  const scene::world_geometry world = scene::flatten(s);
  bake::hemicube_view view;
  source(world)->render(along_x, view);
  EXPECT_TRUE(sees_wall(view, wall));
}

TEST_P(source_test, glass_is_seen_and_hides_nothing) {
  for (const look& kind : {pane, turned_pane}) {
    tiny_scene s;
    const auto glass = s.wall_x(2, -1, 1, kind);
    const auto wall = s.wall_x(4, -1, 1);
    bake::pose from = along_x;
    from.eye.y = 0.001f;  // a ray through the edge between two panes meets both
    const auto view = look_at(s, from);
    EXPECT_TRUE(sees_wall(view, glass));
    EXPECT_TRUE(sees_wall(view, wall));
    EXPECT_EQ(pixels_of(view, glass) + pixels_of(view, glass + 1), 32u * 32u);
    EXPECT_EQ(pixels_of(view, wall) + pixels_of(view, wall + 1), 16u * 16u) << "what is behind keeps its pixels";
  }
}

TEST_P(source_test, three_panes_in_a_row_and_the_wall_behind_are_all_seen) {
  tiny_scene s;
  const auto wall = s.wall_x(5, -1, 2);
  const auto first = s.wall_x(2, -1, 1, pane);
  const auto third = s.wall_x(4, -1, 1, pane);
  const auto second = s.wall_x(3, -1, 1, turned_pane);
  const auto view = look_at(s);
  for (const auto id : {wall, first, second, third}) EXPECT_TRUE(sees_wall(view, id)) << id;
}

TEST_P(source_test, panes_behind_a_wall_are_not_seen) {
  tiny_scene s;
  s.wall_x(2, -1, 2);
  const auto hidden = s.wall_x(3, -1, 1, pane);
  const auto hidden_too = s.wall_x(4, -1, 1, turned_pane);
  const auto view = look_at(s);
  EXPECT_FALSE(sees_wall(view, hidden));
  EXPECT_FALSE(sees_wall(view, hidden_too));
}

TEST_P(source_test, sidedness_holds_for_panes_too) {
  tiny_scene s;
  const auto turned = s.wall_x(2, 1, 1, pane);
  const auto turned_double = s.wall_x(3, 1, 1, look{scene::alpha_mode::blend, true});
  const auto view = look_at(s);
  EXPECT_FALSE(sees_wall(view, turned));
  EXPECT_TRUE(sees_wall(view, turned_double));
}

TEST_P(source_test, a_decal_on_its_wall_is_seen) {
  tiny_scene s;
  const auto wall = s.wall_x(2, -1, 1);
  const auto decal = s.wall_x(2, -1, 1, pane);
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, wall));
  EXPECT_TRUE(sees_wall(view, decal));
}

TEST_P(source_test, what_never_hides_is_seen_where_it_is) {
  tiny_scene s;
  const auto wall = s.wall_x(9, -1, 20), door = s.wall_x(2, -1, 1), hidden = s.wall_x(10, -1, 1);
  // Faces -x; u runs along +z from -2 to 2; there where u is below a half.
  const auto leaf = s.masked_quad({3, -2, -2}, {3, -2, 2}, {3, 2, 2}, {3, 2, -2}, {2, 1, {255, 0}});
  const auto bird = s.wall_x(4, -1, 1);
  for (const auto id : {door, leaf, hidden}) s.tag(id, {.occluder = false});
  s.tag(bird, {.animated = true});
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, wall));
  EXPECT_TRUE(sees_wall(view, door));
  EXPECT_FALSE(sees(view, hidden) || sees(view, hidden + 1));
  EXPECT_FALSE(sees(view, bird)) << "in every set without being looked for";
  // Half of a square that spans 4/6 of the front image; the wall keeps all pixels that it would have.
  const std::uint32_t expected = size * size * 4 / 9 / 2;
  EXPECT_NEAR(pixels_of(view, leaf) + pixels_of(view, leaf + 1), expected, expected / 10);
  EXPECT_EQ(all_pixels(view) - pixels_of(view, leaf) - pixels_of(view, leaf + 1) - pixels_of(view, door) -
                pixels_of(view, door + 1),
            std::uint64_t{pixels_of(view, wall)} + pixels_of(view, wall + 1));
}

TEST_P(source_test, degenerate_polygons_are_never_seen) {
  tiny_scene s;
  const auto line = s.triangle({2, -1, -1}, {2, 0, 0}, {2, 1, 1});
  const auto point = s.triangle({2, 0, 0}, {2, 0, 0}, {2, 0, 0}, both_sides);
  const auto not_finite = s.triangle({2, -1, 1}, {2, std::nanf(""), -1}, {2, 1, 0}, both_sides);
  const auto wall = s.wall_x(4, -1, 1);
  const auto view = look_at(s);
  for (const auto id : {line, point, not_finite}) EXPECT_FALSE(sees(view, id)) << id;
  EXPECT_TRUE(sees_wall(view, wall));
}

TEST_P(source_test, polygons_through_the_near_plane_are_cut_there) {
  tiny_scene s;
  // A floor under the eye that begins far behind it, and a blade that passes 5 cm beside it.
  const auto floor = s.quad({-50, -0.05f, -50}, {-50, -0.05f, 50}, {50, -0.05f, 50}, {50, -0.05f, -50});
  const auto blade = s.triangle({-1, -0.04f, 0.05f}, {1, 0.2f, 0.05f}, {1, -0.04f, 0.05f}, both_sides);
  const auto view = look_at(s);
  EXPECT_TRUE(sees(view, floor));
  EXPECT_TRUE(sees(view, floor + 1));
  EXPECT_TRUE(sees(view, blade));
}

TEST_P(source_test, a_wall_two_millimeters_away_is_seen) {
  tiny_scene s;
  const auto wall = s.wall_x(0.002f, -1, 10);
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, wall));
  EXPECT_EQ(all_pixels(view), 3u * size * size);
}

TEST_P(source_test, huge_polygons_fill_what_they_cover) {
  tiny_scene s;
  const float far_away = 1e6f;
  const auto floor = s.quad({-far_away, -2, -far_away}, {-far_away, -2, far_away}, {far_away, -2, far_away},
                            {far_away, -2, -far_away});
  const auto hidden = s.quad({3, -3, -1}, {3, -3, 1}, {5, -3, 1}, {5, -3, -1});
  const auto view = look_at(s);
  // The lower half of the front, left and right images and all of the lower one.
  EXPECT_EQ(pixels_of(view, floor) + pixels_of(view, floor + 1), 3u * size * size / 2);
  EXPECT_FALSE(sees(view, hidden) || sees(view, hidden + 1));
}

TEST_P(source_test, far_from_the_origin_pixels_are_the_same) {
  const auto pixels_at = [&](float place) {
    tiny_scene s;
    const auto wall = s.wall_x(place + 2, -1, 1);
    bake::pose from = along_x;
    from.eye.x = place;
    const auto view = look_at(s, from);
    return pixels_of(view, wall) + pixels_of(view, wall + 1);
  };
  EXPECT_EQ(pixels_at(16384), pixels_at(0));
}

SIGHTCELL_TEST_ALL_SOURCES(source_test);

}  // namespace
