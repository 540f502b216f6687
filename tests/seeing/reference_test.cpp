// The reference itself, on cases that can be worked out by hand: before it judges the bake.
#include "reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "unit/bake/tiny_scene.h"

namespace sightcell::test {
namespace {

using list = std::vector<std::uint32_t>;
using look_of = tiny_scene::look;

constexpr look_of glass{scene::alpha_mode::blend, true}, both_sides{scene::alpha_mode::opaque, true};
constexpr glm::dvec3 along_x{1, 0, 0}, origin{0, 0, 0};

ray_view look(const scene::scene& s, const glm::dvec3& eye, const glm::dvec3& direction, seeing_rules rules = {}) {
  ray_view view;
  brute_force(s, rules).look(eye, direction, view);
  std::sort(view.front.begin(), view.front.end());
  std::sort(view.before.begin(), view.before.end());
  return view;
}

// A triangle at x = place that faces -x, wide and high around the axis.
std::uint32_t target(tiny_scene& tiny, float place, look_of how = {}) {
  return tiny.triangle({place, -9, -9}, {place, -9, 9}, {place, 9, 0}, how);
}
std::uint32_t turned_target(tiny_scene& tiny, float place, look_of how = {}) {
  return tiny.triangle({place, -9, 9}, {place, -9, -9}, {place, 9, 0}, how);
}

TEST(reference, the_nearest_that_hides_ends_a_ray) {
  tiny_scene tiny;
  const auto far = target(tiny, 4), near = target(tiny, 3);
  const scene::scene s = tiny.finished();
  const ray_view ahead = look(s, origin, along_x);
  EXPECT_EQ(ahead.front, list{near});
  EXPECT_DOUBLE_EQ(ahead.distance, 3.0);
  EXPECT_EQ(look(s, {3.5, 0, 0}, along_x).front, list{far});
  EXPECT_EQ(look(s, origin, -along_x).front, list{});
  EXPECT_EQ(look(s, {0, 10, 0}, along_x).front, list{});
}

TEST(reference, backs_are_not_there_and_glass_does_not_hide) {
  tiny_scene tiny;
  turned_target(tiny, 1);
  const auto pane = target(tiny, 2, glass), second_pane = turned_target(tiny, 3, glass);
  const auto sheet = turned_target(tiny, 4, both_sides);
  target(tiny, 5, glass);
  const scene::scene s = tiny.finished();
  const ray_view ahead = look(s, origin, along_x);
  EXPECT_EQ(ahead.before, (list{pane, second_pane}));
  EXPECT_EQ(ahead.front, list{sheet});
  seeing_rules all;
  all.all_double_sided = true;
  EXPECT_EQ(look(s, origin, along_x, all).front, list{0});
}

TEST(reference, a_mask_is_there_from_its_cutoff_on) {
  tiny_scene tiny;
  // Two texels, 0 and 255, side by side along z: alpha is 0.5 in the middle, at z = 0. The texture repeats.
  const auto fence = tiny.masked_quad({2, -1, -1}, {2, -1, 1}, {2, 1, 1}, {2, 1, -1}, {2, 1, {0, 255}});
  const auto behind = target(tiny, 3);
  const scene::scene s = tiny.finished();
  EXPECT_EQ(look(s, {0, 0, -0.01}, along_x).front, list{behind});
  const list bar = look(s, {0, 0, 0.01}, along_x).front;
  ASSERT_EQ(bar.size(), 1u);
  EXPECT_TRUE(bar[0] == fence || bar[0] == fence + 1);
  EXPECT_EQ(look(s, {0, 0, 0.99}, along_x).front.at(0) / 2, fence / 2)
      << "between 255 and the next 0, above the cutoff";
}

TEST(reference, mirrored_draws_keep_their_fronts) {
  tiny_scene tiny;
  turned_target(tiny, -3);  // faces +x; mirrored it stands at 3 and faces -x
  scene::scene s = tiny.finished();
  s.draws[0].to_world[0][0] = -1.0;
  EXPECT_EQ(look(s, origin, along_x).front, list{0});
  EXPECT_EQ(look(s, {6, 0, 0}, -along_x).front, list{});
}

TEST(reference, coincident_is_within_eps_of_the_front) {
  for (const auto& [place, behind, coincident] : {std::tuple{1.0f, 0.00019f, true},
                                                  std::tuple{1.0f, 0.00021f, false},
                                                  std::tuple{100.0f, 0.0019f, true},
                                                  {100.0f, 0.0021f, false}}) {
    tiny_scene tiny;
    const auto wall = target(tiny, place), decal = target(tiny, place + behind);
    const ray_view view = look(tiny.finished(), origin, along_x);
    EXPECT_EQ(view.front, coincident ? (list{wall, decal}) : list{wall}) << place << " + " << behind;
  }
}

TEST(reference, duplicates_are_seen_together) {
  tiny_scene tiny;
  const look_of masked{scene::alpha_mode::mask, false};
  tiny.triangle({2, -1, -1}, {2, -1, 1}, {2, 1, 0}, masked);
  tiny.triangle({2, -1, 1}, {2, -1, -1}, {2, 1, 0}, masked);
  target(tiny, 3);
  tiny.triangle({3, 9, 0}, {3, -9, -9}, {3, -9, 9});
  turned_target(tiny, 3);
  const scene::scene s = tiny.finished();
  EXPECT_EQ(look(s, origin, along_x).front, (list{0, 1})) << "the opposite pair counts as double-sided";
  EXPECT_EQ(look(s, {2.5, 0, 0}, -along_x).front, (list{0, 1}));
  EXPECT_EQ(look(s, {2.5, 0, 0}, along_x).front, (list{2, 3}));
  EXPECT_EQ(look(s, {3.5, 0, 0}, -along_x).front, list{4});
}

// Two walls at x = 2 with a crack of this width around z = 0, and a target behind them.
scene::scene cracked(double width, float behind) {
  tiny_scene tiny;
  const auto half = static_cast<float>(width / 2);
  tiny.quad({2, -9, -9}, {2, -9, -half}, {2, 9, -half}, {2, 9, -9});
  tiny.quad({2, -9, half}, {2, -9, 9}, {2, 9, 9}, {2, 9, half});
  target(tiny, 2 + behind);
  return tiny.finished();
}

TEST(reference, nothing_is_seen_through_a_crack) {
  EXPECT_EQ(look(cracked(0.0036, 1), origin, along_x).front, list{});
  EXPECT_EQ(look(cracked(0.0041, 1), origin, along_x).front, list{4});
  EXPECT_EQ(look(cracked(0.0036, 0.019f), origin, along_x).front, list{4}) << "right behind it";
  EXPECT_EQ(look(cracked(0.0036, 0.022f), origin, along_x).front, list{});
  seeing_rules fine;
  fine.smallest_gap = 0.001;
  EXPECT_EQ(look(cracked(0.0036, 1), origin, along_x, fine).front, list{4});
  fine.smallest_gap = 0.0;
  EXPECT_EQ(look(cracked(0.0001, 1), origin, along_x, fine).front, list{4});
  // 1 % of the distance: from 200 m away, 2 m.
  seeing_rules coarse;
  coarse.smallest_gap = 0.1;
  EXPECT_EQ(look(cracked(0.1, 1.9f), {-198, 0, 0}, along_x, coarse).front, list{4});
  EXPECT_EQ(look(cracked(0.1, 2.2f), {-198, 0, 0}, along_x, coarse).front, list{});
}

TEST(reference, glass_behind_a_crack_is_not_seen_and_glass_makes_none) {
  tiny_scene tiny;
  tiny.quad({2, -9, -9}, {2, -9, 0}, {2, 9, 0}, {2, 9, -9}, glass);
  tiny.quad({2, -9, 0.001f}, {2, -9, 9}, {2, 9, 9}, {2, 9, 0.001f}, glass);
  target(tiny, 3);
  EXPECT_EQ(look(tiny.finished(), {0, 0, 0.0005}, along_x).front, list{4});
  tiny_scene walled;
  walled.quad({2, -9, -9}, {2, -9, 0}, {2, 9, 0}, {2, 9, -9});
  walled.quad({2, -9, 0.001f}, {2, -9, 9}, {2, 9, 9}, {2, 9, 0.001f});
  target(walled, 3, glass);
  const ray_view view = look(walled.finished(), {0, 0, 0.0005}, along_x);
  EXPECT_TRUE(view.front.empty() && view.before.empty());
}

TEST(reference, free_places_keep_off_surfaces_and_out_of_solids) {
  tiny_scene tiny;
  tiny.closed_box({-1, -1, -1}, {1, 1, 1});
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const scene::scene s = tiny.finished();
  const brute_force judge(s, {});
  EXPECT_DOUBLE_EQ(judge.backs({0.2, 0.3, 0.4}), 1.0);
  EXPECT_DOUBLE_EQ(judge.backs({4, 5, 6}), 0.0);
  EXPECT_FALSE(judge.is_free({0.2, 0.3, 0.4}));
  EXPECT_TRUE(judge.is_free({1.051, 0.2, 0.1}));
  EXPECT_FALSE(judge.is_free({1.049, 0.2, 0.1}));
  const double edge = 1.0 + 0.05 / std::sqrt(2.0);
  EXPECT_TRUE(judge.is_free({edge + 1e-4, edge + 1e-4, 0.3}));
  EXPECT_FALSE(judge.is_free({edge - 1e-4, edge - 1e-4, 0.3}));
  const double corner = 1.0 + 0.05 / std::sqrt(3.0);
  EXPECT_TRUE(judge.is_free({corner + 1e-4, corner + 1e-4, corner + 1e-4}));
  EXPECT_FALSE(judge.is_free({corner - 1e-4, corner - 1e-4, corner - 1e-4}));
}

TEST(reference, only_opaque_single_sided_polygons_tell_solids) {
  tiny_scene open, turned;
  turned_target(open, 2);  // a sixth or so of all directions, and nothing else is hit
  EXPECT_DOUBLE_EQ(brute_force(open.finished(), {}).backs(origin), 1.0);
  turned_target(turned, 2, both_sides);
  turned_target(turned, 3, glass);
  EXPECT_DOUBLE_EQ(brute_force(turned.finished(), {}).backs(origin), 0.0);
}

TEST(reference, knows_what_touches_a_box) {
  tiny_scene tiny;
  const auto around = tiny.triangle({-9, 0, -9}, {9, 0, -9}, {0, 0, 30});  // cuts through; no corner is inside
  const auto inside = tiny.triangle({0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0});
  const auto beside = tiny.triangle({1.01f, -9, -9}, {1.01f, 9, -9}, {1.01f, 0, 9});
  const auto past_edge = tiny.triangle({2.1f, 0, -9}, {0, 2.1f, -9}, {1.05f, 1.05f, 9});  // x + y = 2.1
  const auto at_edge = tiny.triangle({1.9f, 0, -9}, {0, 1.9f, -9}, {0.95f, 0.95f, 9});
  // Its box and its plane meet the box; only x + y >= 2.1 keeps it off.
  const auto leaning = tiny.triangle({2.1f, 0, 0}, {0, 2.1f, 0}, {3, 3, 5});
  const auto past_corner = tiny.triangle({3.1f, 0, 0}, {0, 3.1f, 0}, {0, 0, 3.1f});
  const scene::scene s = tiny.finished();
  const brute_force judge(s, {});
  const place_box box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_TRUE(judge.touches(around, box) && judge.touches(inside, box) && judge.touches(at_edge, box));
  EXPECT_FALSE(judge.touches(beside, box));
  EXPECT_FALSE(judge.touches(past_edge, box));
  EXPECT_FALSE(judge.touches(leaning, box));
  EXPECT_FALSE(judge.touches(past_corner, box));
  EXPECT_TRUE(judge.faces(inside, {0, 0, 5}));
  EXPECT_FALSE(judge.faces(inside, {0, 0, -5}));
}

// A square of side 2 at distance 1, seen from its axis: one side of a cube, a sixth of the sphere.
TEST(reference, shares_are_solid_angles) {
  tiny_scene tiny;
  tiny.closed_box({-1, -1, -1}, {1, 1, 1}, true);
  const scene::scene s = tiny.finished();
  const brute_force judge(s, {});
  const place_box middle{{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}};
  const seeing_effort effort{2, 5, 2000, 1, 7};
  const seen_polygons seen = judge.see(middle, effort);
  EXPECT_EQ(seen.eyes, 40u);
  EXPECT_EQ(seen.rays, 80'000u);
  for (std::uint32_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(seen.share(i), 1.0 / 12.0, 0.005);
    EXPECT_FALSE(seen.inside[i]);
  }
  EXPECT_NEAR(judge.error_of({0, 1, 2, 3, 6, 7, 8, 9, 11}, middle, effort), 0.25, 0.01);
  EXPECT_DOUBLE_EQ(judge.error_of({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, middle, effort), 0.0);
}

TEST(reference, what_touches_the_box_and_faces_a_free_place_is_inside) {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const auto pillar = tiny.closed_box({-0.2f, -3, -0.2f}, {0.2f, 3, 0.2f});
  const auto outward = tiny.wall_x(1, +1, 0.1f);  // touches; all places are behind its plane
  const scene::scene s = tiny.finished();
  const seen_polygons seen = brute_force(s, {}).see({{-1, -1, -1}, {1, 1, 1}}, {4, 2, 10, 1, 7});
  EXPECT_LT(seen.eyes, 128u) << "some lie in the pillar";
  EXPECT_EQ(std::count(seen.inside.begin(), seen.inside.end(), true), 8);
  EXPECT_FALSE(seen.inside[outward] || seen.inside[outward + 1]);
  EXPECT_FALSE(seen.inside[pillar + 4] || seen.inside[pillar + 5]) << "its bottom";
}

TEST(reference, obeys_tags_and_levels) {
  tiny_scene tiny;
  const auto tagged = target(tiny, 2), behind = target(tiny, 3), level_0 = target(tiny, 4);
  const auto level_1 = target(tiny, 1), other = target(tiny, 9), other_coarse = target(tiny, 10);
  scene::scene s = tiny.finished();
  s.draws[3].lod_object = s.draws[2].lod_object = 5;
  s.draws[3].lod_level = 1;
  s.draws[4].lod_object = s.draws[5].lod_object = 7;
  s.draws[5].lod_level = 2;
  struct row {
    const char* name;
    scene::draw_tags tags;
    list front, before;
    bool told;
  };
  scene::draw_tags loose, grouped, dynamic, always, never, both, animated;
  loose.occluder = false, grouped.group = 0, dynamic.dynamic = true, always.always = true, never.never = true;
  both.always = true, both.occluder = false, animated.animated = true;
  const place_box box{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
  for (const row& r : {row{"static", {}, {tagged}, {}, false}, row{"occluder: false", loose, {behind}, {tagged}, false},
                       row{"group", grouped, {behind}, {tagged}, false}, row{"dynamic", dynamic, {behind}, {}, false},
                       row{"always", always, {tagged}, {}, true}, row{"never", never, {behind}, {}, false},
                       row{"always, occluder: false", both, {behind}, {tagged}, true},
                       row{"animated", animated, {behind}, {tagged}, true}}) {
    s.draws[0].tags = r.tags;
    const ray_view view = look(s, origin, along_x);
    EXPECT_EQ(view.front, r.front) << r.name;
    EXPECT_EQ(view.before, r.before) << r.name;
    const seen_polygons seen = brute_force(s, {}).see(box, {2, 1, 10, 5, 7});
    EXPECT_EQ(seen.told[tagged], r.told) << r.name;
    EXPECT_FALSE(seen.told[level_1] || seen.told[other_coarse]) << "level 0 is hidden";
  }
  seeing_rules rest, left_out;
  rest.animated = scene::animated_as::rest, left_out.animated = scene::animated_as::dynamic;
  s.draws[0].tags = animated;
  EXPECT_EQ(look(s, origin, along_x, rest).front, list{tagged});
  EXPECT_EQ(look(s, origin, along_x, left_out).front, list{behind});
  EXPECT_TRUE(look(s, origin, along_x, left_out).before.empty());
  // Seen now, so its coarser level is in; the other object is still hidden by it.
  s.draws[0].tags = s.draws[1].tags = never;
  const seen_polygons seen = brute_force(s, {}).see(box, {2, 1, 10, 5, 7});
  EXPECT_TRUE(seen.told[level_1]);
  EXPECT_FALSE(seen.told[other_coarse]);
  EXPECT_TRUE(seen.belongs(level_0));
  EXPECT_FALSE(seen.belongs(other));
}

}  // namespace
}  // namespace sightcell::test
