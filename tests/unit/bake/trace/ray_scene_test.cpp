#include "trace/ray_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sightcell/base/random.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;
constexpr tiny_scene::look glass{scene::alpha_mode::blend, false};
constexpr tiny_scene::look fence{scene::alpha_mode::mask, true};
const scene::alpha_map left_half{2, 1, {255, 0}};  // passes for u from 0 to 0.5

bool sees(const sight& s, std::uint32_t quad) {
  const auto is = [&](std::uint32_t id) { return id == quad || id == quad + 1; };
  if (is(s.front)) return true;
  for (const passed_polygon& p : s.before)
    if (is(p.polygon)) return true;
  return false;
}

struct world {
  scene::scene s;
  scene::world_geometry geometry;
  explicit world(tiny_scene tiny) : s(tiny.finished()), geometry(scene::flatten(s)) {}
};

TEST(ray_scene, nearest_opaque_polygon_occludes) {
  tiny_scene tiny;
  const auto near = tiny.wall_x(2, -1, 1), far = tiny.wall_x(4, -1, 1);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  sight s;
  rays.trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, near));
  EXPECT_FALSE(sees(s, far));
  EXPECT_FLOAT_EQ(s.distance, 2.0f);
  rays.trace({0, 0.1f, 0.2f}, {-1, 0, 0}, s);
  EXPECT_EQ(s.front, no_polygon);
}

TEST(ray_scene, backs_of_single_sided_polygons_are_not_there) {
  tiny_scene tiny;
  const auto back = tiny.wall_x(2, +1, 1), far = tiny.wall_x(4, -1, 1);
  const world w(tiny);
  sight s;
  ray_scene(w.geometry, false).trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  EXPECT_FALSE(sees(s, back));
  EXPECT_TRUE(sees(s, far));
  ray_scene(w.geometry, true).trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, back));
  EXPECT_FALSE(sees(s, far));
}

TEST(ray_scene, packets_see_what_single_rays_see) {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  for (const float place : {2.0f, 3.0f, 4.0f}) tiny.wall_x(place, -1, 1.5f, glass);
  tiny.wall_x(-2, +1, 1);  // seen from behind: not there
  tiny.masked_quad({-1, 1, -3}, {1, 1, -3}, {1, 3, -3}, {-1, 3, -3}, left_half);
  tiny.masked_quad({-1, 1, -4}, {1, 1, -4}, {1, 3, -4}, {-1, 3, -4}, left_half, true);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  random_stream random(1, 1, purpose::verify);
  for (const std::size_t count : {1u, 7u, 8u, 501u}) {
    std::vector<sight_line> lines(count);
    for (sight_line& line : lines) line = {random.in_box(glm::vec3(-1.0f), glm::vec3(1.0f)), random.on_sphere()};
    std::vector<sight> seen(count);
    seen.front().before.push_back({});  // what was there is forgotten
    rays.trace(lines, seen);
    sight alone;
    std::size_t passed = 0;
    for (std::size_t i = 0; i < count; ++i) {
      rays.trace(lines[i].eye, lines[i].direction, alone);
      EXPECT_EQ(seen[i].front, alone.front);
      EXPECT_NEAR(seen[i].distance, alone.distance, 1e-4f);
      ASSERT_EQ(seen[i].before.size(), alone.before.size());
      for (std::size_t k = 0; k < alone.before.size(); ++k)
        EXPECT_EQ(seen[i].before[k].polygon, alone.before[k].polygon);
      passed += alone.before.size();
    }
    if (count > 100) {
      EXPECT_GT(passed, 20u);
    }
  }
}

TEST(ray_scene, glass_is_seen_and_lets_through) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(8, -1, 1), hidden = tiny.wall_x(9, -1, 1, glass);
  const auto pane = tiny.wall_x(2, -1, 1, glass), second = tiny.wall_x(3, -1, 1, glass);
  const auto third = tiny.wall_x(4, +1, 1, {scene::alpha_mode::blend, true}), turned = tiny.wall_x(5, +1, 1, glass);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  sight s;
  rays.trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  for (const auto seen : {wall, pane, second, third}) EXPECT_TRUE(sees(s, seen)) << seen;
  EXPECT_FALSE(sees(s, hidden)) << "glass behind the wall";
  EXPECT_FALSE(sees(s, turned)) << "glass from behind";
}

TEST(ray_scene, what_never_hides_is_seen_and_keeps_no_eye_off) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(8, -1, 4), door = tiny.wall_x(2, -1, 1), hidden = tiny.wall_x(9, -1, 1);
  const auto leaf = tiny.masked_quad({3, -2, -2}, {3, -2, 2}, {3, 2, 2}, {3, 2, -2}, left_half);
  const auto turned = tiny.wall_x(4, 1, 1);
  for (const auto id : {door, leaf, hidden, turned}) tiny.tag(id, {.occluder = false});
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  sight s;
  rays.trace({0, 0.1f, -0.2f}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, door) && sees(s, leaf) && sees(s, wall));
  EXPECT_FALSE(sees(s, hidden) || sees(s, turned));
  ASSERT_EQ(s.before.size(), 2u);
  EXPECT_FLOAT_EQ(s.before[0].distance + s.before[1].distance, 5.0f);
  rays.trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  EXPECT_FALSE(sees(s, leaf)) << "cut away here";
  EXPECT_TRUE(sees(s, door));
  EXPECT_TRUE(rays.is_valid({2.01f, 0.1f, 0.2f}, 0.05f)) << "it may move";
  EXPECT_FALSE(rays.is_valid({7.99f, 0.1f, 0.2f}, 0.05f));
}

TEST(ray_scene, the_front_of_a_set_is_the_next_of_it_that_hides) {
  tiny_scene tiny;
  const auto pane = tiny.wall_x(1, -1, 1, glass), near = tiny.wall_x(2, -1, 1), turned = tiny.wall_x(3, +1, 1),
             door = tiny.wall_x(4, -1, 1);
  const auto iron = tiny.masked_quad({5, -2, -2}, {5, -2, 2}, {5, 2, 2}, {5, 2, -2}, left_half);
  const auto far = tiny.wall_x(6, -1, 1);
  tiny.tag(door, {.occluder = false});
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  const auto front = [&](float z, const std::vector<std::uint32_t>& quads) {
    const auto in_set = [&](std::uint32_t id) {
      return std::any_of(quads.begin(), quads.end(), [&](std::uint32_t q) { return id == q || id == q + 1; });
    };
    const std::uint32_t found = rays.front_of_set({0, 0.1f, z}, {1, 0, 0}, in_set);
    return found == no_polygon ? found : found - found % 2;  // the quad's first polygon
  };
  EXPECT_EQ(front(0.2f, {pane, near, turned, door, iron, far}), near) << "as look() has it";
  EXPECT_EQ(front(0.2f, {pane, turned, door, iron, far}), far) << "neither glass nor back, open door or hole";
  EXPECT_EQ(front(-0.2f, {pane, turned, door, iron, far}), iron) << "the mask is there on its left half";
  EXPECT_EQ(front(0.2f, {pane, turned, door, iron}), no_polygon);
  EXPECT_EQ(front(0.2f, {}), no_polygon);
}

TEST(ray_scene, a_look_at_a_set_has_what_passes_in_it) {
  tiny_scene tiny;
  const auto pane = tiny.wall_x(1, -1, 1, glass), near = tiny.wall_x(2, -1, 1), other = tiny.wall_x(3, -1, 1, glass),
             far = tiny.wall_x(4, -1, 1), last = tiny.wall_x(5, -1, 1, glass);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  sight s;
  const auto passed = [&](std::uint32_t left_out) {
    rays.trace_against_set(
        {0, 0.1f, 0.2f}, {1, 0, 0}, [&](std::uint32_t id) { return id - id % 2 != left_out; }, s);
    std::vector<std::uint32_t> quads;
    for (const passed_polygon& p : s.before) quads.push_back(p.polygon - p.polygon % 2);
    return quads;
  };
  EXPECT_EQ(passed(last), std::vector<std::uint32_t>{pane});
  EXPECT_EQ(s.front - s.front % 2, near);
  EXPECT_EQ(passed(pane), std::vector<std::uint32_t>{});
  EXPECT_EQ(passed(near), (std::vector<std::uint32_t>{pane, other}));
  EXPECT_EQ(s.front - s.front % 2, far);
  EXPECT_FLOAT_EQ(s.distance, 4.0f);
}

TEST(ray_scene, the_front_of_all_is_what_a_ray_sees) {
  tiny_scene tiny;
  for (int i = 1; i < 30; ++i) {
    const auto f = static_cast<float>(i);
    tiny.wall_x(1 + 0.1f * f, i % 2 == 0 ? -1.0f : 1.0f, 0.2f * f, i % 5 == 0 ? glass : tiny_scene::look{});
  }
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  random_stream random(1, 2, purpose::verify);
  sight s;
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 eye = random.in_box(glm::vec3{-1.0f}, glm::vec3{0.9f}), direction = random.on_sphere();
    rays.trace(eye, direction, s);
    EXPECT_EQ(rays.front_of_set(eye, direction, [](std::uint32_t) { return true; }), s.front);
    hits += s.front != no_polygon;
  }
  EXPECT_GT(hits, 100);
}

TEST(ray_scene, a_closed_box_that_may_move_is_no_solid) {
  tiny_scene tiny;
  const auto lift = tiny.closed_box({-1, -1, -1}, {1, 1, 1});
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  EXPECT_FALSE(ray_scene(world(tiny).geometry, false).is_valid({0, 0, 0}, 0.05f));
  tiny.tag(lift, {.occluder = false});
  const world w(tiny);
  EXPECT_TRUE(ray_scene(w.geometry, false).is_valid({0, 0, 0}, 0.05f));
}

TEST(ray_scene, what_is_in_every_set_hides_unless_it_may_move) {
  tiny_scene tiny;
  const auto sky = tiny.wall_x(4, -1, 1), bird = tiny.wall_x(2, -1, 1), wall = tiny.wall_x(8, -1, 1);
  tiny.tag(sky, {.always = true});
  tiny.tag(bird, {.animated = true});
  const world w(tiny);
  sight s;
  ray_scene(w.geometry, false).trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, sky));
  EXPECT_FALSE(sees(s, wall));
  EXPECT_TRUE(sees(s, bird)) << "verify asks for it";
  EXPECT_EQ(s.before.size(), 1u);
}

TEST(ray_scene, walls_of_two_layers_back_to_back_make_no_solid) {
  for (const bool first_inward : {true, false}) {
    tiny_scene tiny;
    tiny.closed_box({-5, -5, -5}, {5, 5, 5}, first_inward);
    tiny.closed_box({-5, -5, -5}, {5, 5, 5}, !first_inward);
    const world w(tiny);
    const ray_scene rays(w.geometry, false);
    random_stream random(1, 1, purpose::verify);
    for (int i = 0; i < 50; ++i) EXPECT_TRUE(rays.is_valid(random.in_box({-4, -4, -4}, {4, 4, 4}), 0.05f));
  }
}

TEST(ray_scene, a_solid_by_a_little_is_nearly_free) {
  tiny_scene tiny;
  tiny.closed_box({-9, -9, -9}, {9, 9, 9}, true);
  const glm::vec3 middle{0.02f, -0.01f, 0.03f};
  const auto told = [&] {
    const world w(tiny);
    const ray_scene rays(w.geometry, false);
    return std::pair{rays.is_valid(middle, 0.05f), rays.is_nearly_valid(middle, 0.05f)};
  };
  EXPECT_EQ(told(), std::pair(true, true));
  tiny.wall_x(2, 1, 2);  // its back, in a sixth of all directions
  EXPECT_EQ(told(), std::pair(false, true));
  tiny.wall_x(-2, -1, 2);  // in a third
  EXPECT_EQ(told(), std::pair(false, false));
  const world w(tiny);
  EXPECT_FALSE(ray_scene(w.geometry, false).is_nearly_valid({8.97f, 8, 8}, 0.05f)) << "at a surface";
}

TEST(ray_scene, nothing_is_a_solid_where_all_polygons_are_double_sided) {
  tiny_scene tiny;
  tiny.closed_box({-1, -1, -1}, {1, 1, 1});
  const world w(tiny);
  EXPECT_FALSE(ray_scene(w.geometry, false).is_valid({0, 0, 0}, 0.05f));
  EXPECT_TRUE(ray_scene(w.geometry, true).is_valid({0, 0, 0}, 0.05f));
  EXPECT_FALSE(ray_scene(w.geometry, true).is_valid({0.99f, 0, 0}, 0.05f));
}

TEST(ray_scene, coincident_polygons_are_those_within_reach_that_face_the_eye) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(4, -1, 1), same = tiny.wall_x(4, -1, 2), front = tiny.wall_x(3.9999f, -1, 1),
             behind = tiny.wall_x(4.00015f, -1, 1), further = tiny.wall_x(4.001f, -1, 1), back = tiny.wall_x(4, 1, 1),
             pane = tiny.wall_x(4, -1, 1, glass);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  std::vector<std::uint32_t> found;
  const auto has = [&](std::uint32_t quad) {
    return std::any_of(found.begin(), found.end(), [&](std::uint32_t id) { return id == quad || id == quad + 1; });
  };
  rays.coincident({0, 0.1f, 0.2f}, {1, 0, 0}, 4.0f, found);
  for (const auto quad : {wall, same, front, behind, pane}) EXPECT_TRUE(has(quad)) << quad;
  for (const auto quad : {further, back}) EXPECT_FALSE(has(quad)) << quad;
  rays.coincident({-96, 0.1f, 0.2f}, {1, 0, 0}, 100.0f, found);
  EXPECT_TRUE(has(further)) << "2 mm at 100 m";
  rays.stacked({4, 0.1f, 0.2f}, {1, 0, 0}, 2e-4f, found);
  for (const auto quad : {wall, same, front, behind, pane, back}) EXPECT_TRUE(has(quad)) << quad;
  EXPECT_FALSE(has(further));
}

// Two walls at x = 2 with a crack of this width between them, turned about the x axis by the angle; the quad behind.
world cracked(float width, float angle) {
  tiny_scene tiny;
  const auto at = [&](float across, float along) {
    return glm::vec3{2, across * std::cos(angle) - along * std::sin(angle),
                     across * std::sin(angle) + along * std::cos(angle)};
  };
  const float half = width / 2;
  const tiny_scene::look sheet{scene::alpha_mode::opaque, true};
  tiny.quad(at(half, -9), at(9, -9), at(9, 9), at(half, 9), sheet);
  tiny.quad(at(-half, -9), at(-9, -9), at(-9, 9), at(-half, 9), sheet);
  tiny.wall_x(3, -1, 9);
  return world(tiny);
}

TEST(ray_scene, narrow_cracks_let_nothing_through_and_wide_ones_all) {
  for (const float angle : {0.0f, 0.785f, 1.571f, 2.356f, 0.35f, 2.0f}) {
    const world narrow = cracked(0.0015f, angle), wide = cracked(0.0045f, angle);
    const ray_scene through_narrow(narrow.geometry, false), through_wide(wide.geometry, false);
    sight s;
    through_narrow.trace({0, 0, 0}, {1, 0, 0}, s);
    ASSERT_FLOAT_EQ(s.distance, 3.0f) << angle;
    EXPECT_TRUE(through_narrow.through_gap({0, 0, 0}, {1, 0, 0}, 3.0f, 0.002f)) << angle;
    EXPECT_FALSE(through_wide.through_gap({0, 0, 0}, {1, 0, 0}, 3.0f, 0.002f)) << angle;
    EXPECT_FALSE(through_narrow.through_gap({0, 0, 0}, {1, 0, 0}, 3.0f, 0.0f)) << "0 turns it off";
    EXPECT_FALSE(through_narrow.through_gap({0, 0, 0}, {1, 0, 0}, 2.01f, 0.002f)) << "blocked less than 2 cm before";
  }
}

TEST(ray_scene, an_edge_is_no_crack) {
  tiny_scene tiny;
  tiny.quad({2, 0.0005f, 9}, {2, 9, 9}, {2, 9, -9}, {2, 0.0005f, -9}, {scene::alpha_mode::opaque, true});
  tiny.wall_x(3, -1, 9);
  const world w(tiny);
  EXPECT_FALSE(ray_scene(w.geometry, false).through_gap({0, 0, 0}, {1, 0, 0}, 3.0f, 0.002f));
}

TEST(ray_scene, a_mask_without_texture_is_a_wall) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(8, -1, 1), iron = tiny.wall_x(4, +1, 1, fence);
  const world w(tiny);
  sight s;
  ray_scene(w.geometry, false).trace({0, 0.1f, 0.2f}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, iron));
  EXPECT_FALSE(sees(s, wall));
}

TEST(ray_scene, a_mask_is_there_where_its_alpha_passes_and_nowhere_else) {
  tiny_scene tiny;
  const auto wall = tiny.wall_x(8, -1, 4);
  // Faces -x; u runs along +z from -2 to 2.
  const auto iron = tiny.masked_quad({4, -2, -2}, {4, -2, 2}, {4, 2, 2}, {4, 2, -2}, left_half);
  const auto turned = tiny.masked_quad({3, -2, 2}, {3, -2, -2}, {3, 2, -2}, {3, 2, 2}, left_half);
  const auto both = tiny.masked_quad({5, 5, -2}, {5, 5, 2}, {5, 7, 2}, {5, 7, -2}, left_half, true);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  sight s;
  rays.trace({0, 0, -1}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, iron));
  EXPECT_FALSE(sees(s, wall));
  EXPECT_FLOAT_EQ(s.distance, 4.0f);
  rays.trace({0, 0, 1}, {1, 0, 0}, s);
  EXPECT_FALSE(sees(s, iron)) << "cut away here";
  EXPECT_TRUE(sees(s, wall));
  EXPECT_FALSE(sees(s, turned)) << "single-sided, from behind";
  rays.trace({9, 6, -1}, {-1, 0, 0}, s);
  EXPECT_TRUE(sees(s, both)) << "double-sided, from behind";
  rays.trace({9, 6, 1}, {-1, 0, 0}, s);
  EXPECT_EQ(s.front, no_polygon);
}

TEST(ray_scene, masks_and_solids_mix) {
  // A mask still ends the rays that tell solids, all over, and has no vote: only opaque single-sided backs have one.
  tiny_scene tiny;
  tiny.closed_box({-1, -1, -1}, {1, 1, 1});
  const auto iron = tiny.masked_quad({-9, 3, -9}, {9, 3, -9}, {9, 3, 9}, {-9, 3, 9}, {1, 2, {0, 255}}, true);
  const world w(tiny);
  EXPECT_TRUE(w.geometry.kinds[iron].alpha_tested);
  const ray_scene rays(w.geometry, false);
  EXPECT_FALSE(rays.is_valid({0, 0, 0}, 0.05f));
  EXPECT_TRUE(rays.is_valid({0, 2, 0}, 0.05f));
  EXPECT_FALSE(rays.is_valid({0, 3.01f, 0}, 0.05f)) << "at the mask's surface";
}

TEST(ray_scene, a_pane_behind_the_wall_is_not_seen_whatever_is_met_first) {
  // The pane's bounds begin before the wall's, so that the tree is likely to offer its hit, behind the wall, first.
  tiny_scene tiny;
  const auto hidden = tiny.quad({1, -9, -9}, {12, -9, 9}, {12, 9, 9}, {1, 9, -9}, {scene::alpha_mode::blend, true});
  std::uint32_t wall = scene::no_index;
  for (int i = 0; i < 32; ++i) {
    const float low = -8.0f + 0.5f * static_cast<float>(i);
    const auto strip = tiny.quad({4, low, -4}, {4, low, 8}, {4, low + 0.5f, 8}, {4, low + 0.5f, -4});
    wall = std::min(wall, strip);
  }
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  random_stream random(3, 3, purpose::verify);
  sight s;
  for (int i = 0; i < 200; ++i) {
    rays.trace({0, 0, 0}, glm::normalize(random.in_box({4, -3, 0}, {4, 3, 3})), s);
    EXPECT_GE(s.front, wall);
    EXPECT_FALSE(sees(s, hidden));
  }
}

TEST(ray_scene, nan_and_slivers_are_never_seen) {
  tiny_scene tiny;
  const auto sliver = tiny.triangle({2, 0, 0}, {2, 1, 0}, {2, 2, 0});
  const auto broken = tiny.triangle({1, 0, 0}, {1, std::numeric_limits<float>::quiet_NaN(), 0}, {1, 0, 1});
  const auto wall = tiny.wall_x(4, -1, 1);
  const world w(tiny);
  EXPECT_TRUE(w.geometry.kinds[sliver].absent);
  EXPECT_TRUE(w.geometry.kinds[broken].absent);
  sight s;
  ray_scene(w.geometry, false).trace({0, 0.1f, 0.0f}, {1, 0, 0}, s);
  EXPECT_TRUE(sees(s, wall));
}

TEST(ray_scene, places_in_solids_and_at_surfaces_are_not_free) {
  tiny_scene tiny;
  tiny.closed_box({-10, -10, -10}, {10, 10, 10}, true);  // a room
  tiny.closed_box({2, -10, -2}, {4, 10, 2});             // a pillar in it
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  EXPECT_TRUE(rays.is_valid({0, 0, 0}, 0.05f));
  EXPECT_FALSE(rays.is_valid({3, 0, 0}, 0.05f)) << "inside the pillar";
  EXPECT_FALSE(rays.is_valid({1.96f, 0, 0}, 0.05f)) << "too close to it";
  EXPECT_TRUE(rays.is_valid({1.94f, 0, 0}, 0.05f));
  EXPECT_FALSE(rays.is_valid({12, 0, 0}, 0.05f)) << "behind the room's walls";
}

TEST(ray_scene, a_tenth_of_backs_tells_a_solid) {
  // A back seen under 6 % of all directions is a loose end of the model; under 17 % the place is inside something.
  for (const auto& [half, free] : {std::pair{0.5f, true}, std::pair{1.0f, false}}) {
    tiny_scene tiny;
    tiny.closed_box({-10, -10, -10}, {10, 10, 10}, true);
    tiny.wall_x(1, +1, half);
    const world w(tiny);
    EXPECT_EQ(ray_scene(w.geometry, false).is_valid({0, 0, 0}, 0.05f), free) << half;
  }
  // Overhead, where the first of the fixed directions go: the answer may not be given before the rest had their say.
  tiny_scene tiny;
  tiny.closed_box({-10, -10, -10}, {10, 10, 10}, true);
  tiny.quad({-0.5f, 1, 0.5f}, {0.5f, 1, 0.5f}, {0.5f, 1, -0.5f}, {-0.5f, 1, -0.5f});
  const world w(tiny);
  EXPECT_TRUE(ray_scene(w.geometry, false).is_valid({0, 0, 0}, 0.05f));
}

TEST(ray_scene, thin_double_sided_things_are_no_solids) {
  tiny_scene tiny;
  const tiny_scene::look sheet{scene::alpha_mode::opaque, true};
  tiny.wall_x(1, 1, 5, sheet);
  tiny.wall_x(-1, 1, 5, sheet);
  const world w(tiny);
  EXPECT_TRUE(ray_scene(w.geometry, false).is_valid({0, 0, 0}, 0.05f));
}

TEST(ray_scene, many_places_answer_as_one) {
  tiny_scene tiny;
  tiny.closed_box({-1, -1, -1}, {1, 1, 1});
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  random_stream random(1, 2, purpose::viewpoints);
  std::vector<glm::vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back(random.in_box(glm::vec3{-2.0f}, glm::vec3{2.0f}));
  std::vector<std::uint8_t> free(points.size());
  rays.find_valid(points, 0.05f, free);
  int inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(free[i] != 0, rays.is_valid(points[i], 0.05f));
    inside += free[i] == 0;
  }
  EXPECT_GT(inside, 5);
  EXPECT_LT(inside, 40);
}

TEST(triangle_math, distance) {
  const triangle t{glm::vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_FLOAT_EQ(distance_to_triangle({0.2f, 0.2f, 3}, t), 3.0f);
  EXPECT_FLOAT_EQ(distance_to_triangle({-3, -4, 0}, t), 5.0f);
  EXPECT_FLOAT_EQ(distance_to_triangle({0.5f, -2, 0}, t), 2.0f);
  EXPECT_FLOAT_EQ(distance_to_triangle({1, 1, 0}, t), std::sqrt(0.5f));
  EXPECT_FLOAT_EQ(distance_to_triangle({3, 0, 0}, t), 2.0f);
}

TEST(triangle_math, touching_a_box) {
  const glm::vec3 low{0.0f}, high{1.0f};
  EXPECT_TRUE(triangle_touches_box({glm::vec3{-9, 0.5f, -9}, {9, 0.5f, -9}, {0, 0.5f, 9}}, low, high))
      << "cuts through";
  EXPECT_TRUE(triangle_touches_box({glm::vec3{0.4f, 0.4f, 0.4f}, {0.5f, 0.4f, 0.4f}, {0.4f, 0.5f, 0.4f}}, low, high));
  EXPECT_FALSE(triangle_touches_box({glm::vec3{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}, low, high));
  // Its bounds overlap the box, its plane passes by a corner.
  EXPECT_FALSE(triangle_touches_box({glm::vec3{2.2f, 0, 0}, {0, 2.2f, 0}, {1.1f, 1.1f, 9}}, low, high));
  EXPECT_TRUE(triangle_touches_box({glm::vec3{1.8f, 0, 0}, {0, 1.8f, 0}, {0.9f, 0.9f, 9}}, low, high));
}

TEST(ray_scene, finds_all_that_touch_a_box_and_no_others) {
  tiny_scene tiny;
  random_stream random(5, 5, purpose::verify);
  const auto place = [&] { return random.in_box({-10, -10, -10}, {10, 10, 10}); };
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 corner = place();
    const float size = i % 10 == 0 ? 1.0f : 0.1f;  // some are larger than the boxes
    tiny.triangle(corner, corner + size * place(), corner + size * place());
  }
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  int touching = 0;
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 min = place(), max = min + glm::vec3{0.2f, 4.0f, 1.0f} * (1.0f + random.uniform());
    std::vector<std::uint32_t> expected;
    for (std::uint32_t polygon = 0; polygon < w.geometry.kinds.size(); ++polygon)
      if (triangle_touches_box(corners_of(w.geometry, polygon), min, max)) expected.push_back(polygon);
    EXPECT_EQ(rays.touching(min, max), expected) << i;
    touching += static_cast<int>(expected.size());
  }
  EXPECT_GT(touching, 50);
}

TEST(viewpoints, finds_what_touches_and_faces) {
  tiny_scene tiny;
  const auto floor = tiny.quad({-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5});
  const auto away = tiny.wall_x(50, -1, 1);
  const world w(tiny);
  const ray_scene rays(w.geometry, false);
  EXPECT_EQ(rays.touching({-1, -1, -1}, {1, 1, 1}), (std::vector<std::uint32_t>{floor, floor + 1}));
  EXPECT_TRUE(faces(rays, floor, {0, 1, 0}));
  EXPECT_FALSE(faces(rays, floor, {0, -1, 0}));
  EXPECT_TRUE(faces(rays, away, {0, -1, 0}));
  EXPECT_FALSE(faces(rays, away, {60, -1, 0}));
  EXPECT_TRUE(faces(ray_scene(w.geometry, true), away, {60, -1, 0})) << "both sides are seen";
}

}  // namespace
}  // namespace sightcell::bake
