// Rule 2: decals and exact duplicates.
#include "seeing_test.h"

namespace sightcell::test {
namespace {

class seeing_coincident : public seeing_test {};

// A hemicube shows one polygon per pixel, which is enough for the picture: what coincides with it joins through rays.
trial found_by_rays() {
  trial t;
  t.hemicube_share = 1.0;
  return t;
}

std::uint32_t room(tiny_scene& tiny) {
  return tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
}

TEST_F(seeing_coincident, a_decal_in_the_wall) {
  tiny_scene tiny;
  const auto around = room(tiny), wall = tiny.wall_x(4, -1, 2), decal = tiny.wall_x(4, -1, 1.5f);
  check(tiny.finished(),
        {.sees = {{"room", around, 12}, {"wall", wall}, {"decal", decal}},
         .does_not_see = {},
         .excused = {{"decal", decal}}},
        found_by_rays());
}

TEST_F(seeing_coincident, a_decal_a_tenth_of_a_millimeter_before_the_wall) {
  tiny_scene tiny;
  const auto around = room(tiny), wall = tiny.wall_x(4, -1, 2), decal = tiny.wall_x(3.9999f, -1, 1.5f);
  check(tiny.finished(),
        {.sees = {{"room", around, 12}, {"wall", wall}, {"decal", decal}},
         .does_not_see = {},
         .excused = {{"decal", decal}}},
        found_by_rays());
}

TEST_F(seeing_coincident, a_decal_a_tenth_of_a_millimeter_behind_the_wall) {
  tiny_scene tiny;
  const auto around = room(tiny), wall = tiny.wall_x(4, -1, 2), decal = tiny.wall_x(4.0001f, -1, 1.5f);
  check(tiny.finished(),
        {.sees = {{"room", around, 12}, {"wall", wall}, {"decal", decal}},
         .does_not_see = {},
         .excused = {{"decal", decal}}},
        found_by_rays());
}

TEST_F(seeing_coincident, a_decal_further_behind_is_hidden) {
  for (const float behind : {0.0005f, 0.005f}) {
    tiny_scene tiny;
    const auto around = room(tiny), wall = tiny.wall_x(4, -1, 2), decal = tiny.wall_x(4 + behind, -1, 1);
    check(tiny.finished(), {.sees = {{"room", around, 12}, {"wall", wall}}, .does_not_see = {{"decal", decal}}});
  }
}

// eps grows with the distance: a millimeter behind the wall counts from 50 m on.
TEST_F(seeing_coincident, far_away_a_millimeter_is_nothing) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(100, -1, 30), decal = tiny.wall_x(100.001f, -1, 25);
  check(tiny.finished(),
        {.sees = {{"wall", wall}, {"decal", decal}}, .does_not_see = {}, .excused = {{"decal", decal}}},
        found_by_rays());
}

TEST_F(seeing_coincident, further_away_four_millimeters_are_nothing) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(300, -1, 90), decal = tiny.wall_x(300.004f, -1, 80);
  check(tiny.finished(),
        {.sees = {{"wall", wall}, {"decal", decal}}, .does_not_see = {}, .excused = {{"decal", decal}}},
        found_by_rays());
}

TEST_F(seeing_coincident, duplicates_are_seen_together) {
  tiny_scene tiny;
  const auto around = room(tiny), wall = tiny.wall_x(4, -1, 2), copy = tiny.wall_x(4, -1, 2);
  // The same triangle, begun at each of its corners.
  const auto first = tiny.triangle({-4, -1, 1}, {-4, -1, -1}, {-4, 1, 0});
  const auto second = tiny.triangle({-4, -1, -1}, {-4, 1, 0}, {-4, -1, 1});
  const auto third = tiny.triangle({-4, 1, 0}, {-4, -1, 1}, {-4, -1, -1});
  const auto hidden = tiny.wall_x(4.1f, -1, 1), hidden_copy = tiny.wall_x(4.1f, -1, 1);
  check(tiny.finished(), {.sees = {{"room", around, 12},
                                   {"wall", wall},
                                   {"its copy", copy},
                                   {"triangle", first, 1},
                                   {"its copy", second, 1},
                                   {"its other copy", third, 1}},
                          .does_not_see = {{"hidden", hidden}, {"its copy", hidden_copy}},
                          .excused = {{"wall", wall}, {"its copy", copy}, {"triangles", first, 3}},
                          .excused_together = false});
}

TEST_F(seeing_coincident, of_an_opposite_opaque_pair_the_one_that_faces_the_cell) {
  tiny_scene tiny;
  const auto around = room(tiny);
  const auto turned = tiny.quad({4, -1, -1}, {4, 1, -1}, {4, 1, 1}, {4, -1, 1});
  const auto facing = tiny.quad({4, -1, -1}, {4, -1, 1}, {4, 1, 1}, {4, 1, -1});
  check(tiny.finished(),
        {.sees = {{"room", around, 12}, {"facing", facing}}, .does_not_see = {{"turned away", turned}}});
}

// Artists put leaves back to back: taken as double-sided.
TEST_F(seeing_coincident, an_opposite_masked_pair_is_seen_as_one) {
  tiny_scene tiny;
  const auto around = room(tiny);
  const scene::alpha_map bars{8, 1, {255, 0, 255, 0, 255, 0, 255, 0}};
  const auto facing = tiny.masked_quad({3, -2, -2}, {3, -2, 2}, {3, 2, 2}, {3, 2, -2}, bars);
  const auto turned = tiny.masked_quad({3, -2, -2}, {3, 2, -2}, {3, 2, 2}, {3, -2, 2}, bars);
  const auto behind_bar = tiny.quad({3.01f, -1, 0.1f}, {3.01f, -1, 0.4f}, {3.01f, 1, 0.4f}, {3.01f, 1, 0.1f});
  const auto behind_hole = tiny.quad({3.01f, -1, 0.6f}, {3.01f, -1, 0.9f}, {3.01f, 1, 0.9f}, {3.01f, 1, 0.6f});
  scene::scene s = tiny.finished();
  s.geometries[2].uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};  // every corner has the coordinates it has in the other
  scene::finish(s);
  check(s, {.sees = {{"room", around, 12}, {"facing", facing}, {"turned away", turned}, {"behind a hole", behind_hole}},
            .does_not_see = {{"behind a bar", behind_bar}},
            .excused = {{"facing", facing}, {"turned away", turned}},
            .excused_together = false});
}

}  // namespace
}  // namespace sightcell::test
