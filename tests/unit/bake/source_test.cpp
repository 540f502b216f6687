#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <random>

#include "errors/error_id.h"
#include "rays/ray_scene.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/error.h"
#include "source/gpu_source.h"
#include "source/hemicube_faces.h"
#include "source/polygon_counts.h"
#include "tiny_scene.h"

namespace {

namespace bake = sightcell::bake;
namespace scene = sightcell::scene;
using sightcell::test::error_id;
using sightcell::test::tiny_scene;
using look = tiny_scene::look;

constexpr std::uint32_t size = 64;
const look pane{scene::alpha_mode::blend, false}, turned_pane{scene::alpha_mode::blend, true};
const look both_sides{scene::alpha_mode::opaque, true};

// Looks from the origin along +x: walls of tiny_scene::wall_x stand across the view.
const bake::pose along_x{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};

// A context for all tests: making one takes longer than a test.
class source_test : public ::testing::TestWithParam<bake::gather> {
 protected:
  static void SetUpTestSuite() {
    try {
      context_ = std::make_unique<sightcell::picture::gl_context>(true);
    } catch (const sightcell::error& e) {
      why_not_ = e.what();
    }
  }
  static void TearDownTestSuite() { context_.reset(); }
  void SetUp() override {
    if (!context_) GTEST_SKIP() << why_not_;
  }

  static std::unique_ptr<bake::hemicube_source> source(const scene::world_geometry& world, bake::gather how,
                                                       std::uint32_t resolution = size, float far_plane = 100.0f) {
    return bake::make_gpu_source(*context_, world, {resolution, far_plane, how});
  }
  // What one hemicube sees, through the gather under test.
  static bake::hemicube_view look_at(tiny_scene& s, const bake::pose& from = along_x) {
    const scene::world_geometry world = scene::flatten(s.finished());
    bake::hemicube_view view;
    source(world, GetParam())->render(from, view);
    return view;
  }

  static std::unique_ptr<sightcell::picture::gl_context> context_;
  static std::string why_not_;
};

std::unique_ptr<sightcell::picture::gl_context> source_test::context_;
std::string source_test::why_not_;

std::uint32_t pixels_of(const bake::hemicube_view& view, std::uint32_t id) {
  for (const bake::seen_polygon& p : view.seen) {
    if (p.id == id) return p.pixels;
  }
  return 0;
}

bool sees(const bake::hemicube_view& view, std::uint32_t id) {
  return pixels_of(view, id) > 0;
}

std::uint64_t all_pixels(const bake::hemicube_view& view) {
  std::uint64_t sum = 0;
  for (const bake::seen_polygon& p : view.seen) sum += p.pixels;
  return sum;
}

// A wall_x is two polygons; both or none must be seen.
bool sees_wall(const bake::hemicube_view& view, std::uint32_t first) {
  EXPECT_EQ(sees(view, first), sees(view, first + 1));
  return sees(view, first);
}

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
  source(world, GetParam())->render(along_x, view);
  EXPECT_TRUE(sees_wall(view, wall));
}

TEST_P(source_test, glass_is_seen_and_hides_nothing) {
  for (const look& kind : {pane, turned_pane}) {
    tiny_scene s;
    const auto glass = s.wall_x(2, -1, 1, kind);
    const auto wall = s.wall_x(4, -1, 1);
    const auto view = look_at(s);
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

// Seen from the origin along +x: faces -x, u runs along +z (to the right) from -half to half, v upward.
std::uint32_t masked_wall_x(tiny_scene& s, float place, float half, scene::alpha_map map, bool double_sided = false) {
  return s.masked_quad({place, -half, -half}, {place, -half, half}, {place, half, half}, {place, half, -half},
                       std::move(map), double_sided);
}

TEST_P(source_test, a_mask_is_seen_and_hides_where_its_alpha_passes) {
  tiny_scene s;
  const auto wall = s.wall_x(4, -1, 2);
  const auto leaf = masked_wall_x(s, 2, 1, {2, 1, {255, 0}});
  const auto view = look_at(s);
  EXPECT_TRUE(sees_wall(view, leaf));
  EXPECT_TRUE(sees_wall(view, wall));
  EXPECT_EQ(pixels_of(view, leaf) + pixels_of(view, leaf + 1), 16u * 32u) << "its left half";
  EXPECT_EQ(pixels_of(view, wall) + pixels_of(view, wall + 1), 16u * 32u) << "what the other half lets through";
}

TEST_P(source_test, a_mask_that_passes_nowhere_or_everywhere) {
  tiny_scene s;
  const auto wall = s.wall_x(5, -1, 1);
  const auto gone = masked_wall_x(s, 2, 1, {2, 2, {127, 127, 127, 127}});
  EXPECT_FALSE(sees_wall(look_at(s), gone));
  EXPECT_TRUE(sees_wall(look_at(s), wall));
  const auto closed = masked_wall_x(s, 3, 1, {2, 2, {128, 128, 255, 255}});
  EXPECT_TRUE(sees_wall(look_at(s), closed));
  EXPECT_FALSE(sees_wall(look_at(s), wall));
}

TEST_P(source_test, masks_know_sides_and_panes_behind_their_holes) {
  tiny_scene s;
  const auto turned = s.masked_quad({2, -1, 1}, {2, -1, -1}, {2, 1, -1}, {2, 1, 1}, {2, 1, {255, 0}});
  const auto leaf = masked_wall_x(s, 3, 1, {2, 1, {255, 0}}, true);
  const auto glass = s.quad({4, -1, -1.2f}, {4, -1, -0.2f}, {4, 1, -0.2f}, {4, 1, -1.2f}, pane);
  const auto seen_glass = s.quad({4, -1, 0.2f}, {4, -1, 1}, {4, 1, 1}, {4, 1, 0.2f}, pane);
  const auto view = look_at(s);
  EXPECT_FALSE(sees(view, turned)) << "from behind";
  EXPECT_TRUE(sees_wall(view, leaf));
  EXPECT_FALSE(sees(view, glass)) << "behind the half that is there";
  EXPECT_TRUE(sees_wall(view, seen_glass)) << "behind the hole";
}

// Leaves of random alpha in perspective, turned, mirrored and crossing each other: as many pixels of each polygon as
// rays see.
TEST_P(source_test, masks_agree_with_rays) {
  std::mt19937 random(7);
  const auto noise = [&](std::uint32_t width, std::uint32_t height) {
    scene::alpha_map map{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) map.texels.push_back(static_cast<std::uint8_t>(random() % 256));
    return map;
  };
  tiny_scene s;
  s.wall_x(9, -1, 20);
  s.masked_quad({2, -3, -1}, {7, -3, 4}, {7, 3, 4}, {2, 3, -1}, noise(7, 5), true);
  s.masked_quad({6, -4, -9}, {3, -4, 3}, {3, 2, 3}, {6, 2, -9}, noise(13, 1), true);
  s.masked_quad({1, -1, -4}, {8, -1, -4}, {8, -1, 4}, {1, -1, 4}, noise(8, 8), true);
  scene::scene finished = s.finished();
  finished.geometries[2].uvs = {{-3.5f, 2}, {4, 2}, {4, -1}, {-3.5f, -1}};  // repeats, and runs backwards
  finished.draws[3].to_world[2][2] = -1.0;
  finished.geometries[1].uvs = {{-0.4f, -0.2f}, {1.7f, -0.2f}, {1.7f, 1.5f}, {-0.4f, 1.5f}};
  finished.materials[1].wrap_u = scene::wrap::mirror;
  finished.materials[1].wrap_v = scene::wrap::clamp;
  finished.geometries[3].colors = {glm::u8vec4(255), {0, 0, 0, 200}, {0, 0, 0, 90}, glm::u8vec4(255)};
  const scene::world_geometry world = scene::flatten(finished);
  ASSERT_EQ(world.masked.size(), 6u);
  // Turned a little, so that no edge runs through pixel centers.
  bake::pose turned = along_x;
  turned.forward = glm::normalize(glm::vec3(1, 0.03f, 0.07f));
  turned.right = glm::normalize(glm::cross(turned.forward, glm::vec3(0, 1, 0.05f)));
  turned.up = glm::cross(turned.right, turned.forward);
  bake::hemicube_view view;
  source(world, GetParam(), 256)->render(turned, view);
  const bake::ray_scene rays(world, false);
  std::vector<std::uint32_t> expected(world.kinds.size(), 0);
  bake::sight seen;
  // Front image: -1..1 in both directions; the half images to the right, left, above and below.
  const auto count = [&](float forward, float up, float right) {
    rays.look({0, 0, 0}, glm::normalize(forward * turned.forward + up * turned.up + right * turned.right), seen);
    if (seen.front != bake::no_polygon) ++expected[seen.front];
  };
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float a = (static_cast<float>(x) + 0.5f) / 128.0f - 1.0f,
                  b = (static_cast<float>(y) + 0.5f) / 128.0f - 1.0f;
      count(1, b, a);
      if (a < 0.0f) continue;  // how far forward: half faces
      count(a, b, 1);
      count(a, b, -1);
      count(a, 1, b);
      count(a, -1, b);
    }
  }
  for (std::uint32_t id = 0; id < expected.size(); ++id)
    EXPECT_NEAR(pixels_of(view, id), expected[id], 4 + expected[id] / 1000) << id;
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

TEST_P(source_test, a_wall_two_millimetres_away_is_seen) {
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
  const auto pixels_at = [](float place) {
    tiny_scene s;
    const auto wall = s.wall_x(place + 2, -1, 1);
    bake::pose from = along_x;
    from.eye.x = place;
    const auto view = look_at(s, from);
    return pixels_of(view, wall) + pixels_of(view, wall + 1);
  };
  EXPECT_EQ(pixels_at(16384), pixels_at(0));
}

// One polygon toward each of the five faces and one behind; the pose is turned, so that no axis is special.
TEST_P(source_test, each_face_sees_what_lies_there) {
  bake::pose from;
  from.eye = {10, 20, -5};
  from.forward = glm::normalize(glm::vec3(1, 2, -2));
  from.up = glm::normalize(glm::cross(from.forward, glm::vec3(0.3f, 1, 0.1f)));
  from.right = glm::cross(from.forward, from.up);

  tiny_scene s;
  const auto toward = [&](const glm::vec3& direction) {
    const glm::vec3 center = from.eye + 3.0f * direction;
    const glm::vec3 u = 0.4f * glm::normalize(glm::cross(direction, glm::vec3(0.1f, 0.9f, 0.3f)));
    const glm::vec3 v = 0.4f * glm::normalize(glm::cross(direction, u));
    return s.triangle(center - u - v, center + u - v, center + v, both_sides);
  };
  // Slightly forward, inside the half that is kept.
  const glm::vec3 f = from.forward;
  const std::vector<std::uint32_t> ahead{
      toward(f), toward(glm::normalize(from.right + 0.3f * f)), toward(glm::normalize(-from.right + 0.3f * f)),
      toward(glm::normalize(from.up + 0.3f * f)), toward(glm::normalize(-from.up + 0.3f * f))};
  const auto behind = toward(-f);
  const auto behind_beside = toward(glm::normalize(from.right - 0.3f * f));
  const auto view = look_at(s, from);
  for (const auto id : ahead) EXPECT_TRUE(sees(view, id)) << id;
  EXPECT_FALSE(sees(view, behind));
  EXPECT_FALSE(sees(view, behind_beside));
}

TEST_P(source_test, in_a_closed_box_every_pixel_belongs_to_a_polygon) {
  tiny_scene s;
  s.closed_box({-3, -2, -4}, {5, 3, 2}, true);
  bake::pose from = along_x;
  from.eye = {0.3f, 0.2f, -0.7f};
  EXPECT_EQ(all_pixels(look_at(s, from)), 3u * size * size);
  from.forward = glm::normalize(glm::vec3(0.4f, 0.3f, -0.8f));
  from.right = glm::normalize(glm::cross(from.forward, glm::vec3(0, 1, 0)));
  from.up = glm::cross(from.right, from.forward);
  EXPECT_EQ(all_pixels(look_at(s, from)), 3u * size * size);
}

TEST_P(source_test, ids_are_ascending_and_unique) {
  tiny_scene s;
  for (int i = 0; i < 20; ++i) {
    const float distance = 20.0f - static_cast<float>(i);  // the farther the larger, so that all are seen
    s.wall_x(distance, -1, 0.05f * distance * distance, i % 2 == 0 ? pane : look{});
  }
  const auto view = look_at(s);
  EXPECT_EQ(view.seen.size(), 40u);
  for (std::size_t i = 1; i < view.seen.size(); ++i) EXPECT_LT(view.seen[i - 1].id, view.seen[i].id);
}

TEST_P(source_test, importance_is_larger_toward_the_side_of_the_gap) {
  // A near wall covers the left of the view (z < 0); the far one shows right of it. Nothing else ends in the view.
  const float end = 1000.0f;
  tiny_scene s;
  s.wall_x(20, -1, end);
  s.quad({2, -end, 0}, {2, -end, -end}, {2, end, -end}, {2, end, 0}, both_sides);
  const auto right = look_at(s).importance;
  EXPECT_GT(right[bake::toward_right], 2 * right[bake::toward_left]);
  EXPECT_GT(right[bake::toward_right], right[bake::toward_up]);
  EXPECT_GT(right[bake::toward_right], right[bake::toward_down]);

  // The same with the near wall below: the gap is above.
  tiny_scene t;
  t.wall_x(20, -1, end);
  t.quad({2, -end, -end}, {2, 0, -end}, {2, 0, end}, {2, -end, end}, both_sides);
  const auto up = look_at(t).importance;
  EXPECT_GT(up[bake::toward_up], 2 * up[bake::toward_down]);
  EXPECT_GT(up[bake::toward_up], up[bake::toward_right]);
}

TEST_P(source_test, importance_of_one_edge_is_what_the_formula_says) {
  // Depth 2 left of the middle of the front image, background (1, with a far plane of 100) right of it. The wall is
  // narrow enough for the front image alone: 16 columns and 16 rows of 64, from (16, 24) to (31, 39).
  tiny_scene s;
  s.quad({2, -0.5f, 0}, {2, -0.5f, -1}, {2, 0.5f, -1}, {2, 0.5f, 0}, both_sides);
  const auto i = look_at(s).importance;
  const double gap = (1.0 - 0.02) / 0.02;
  EXPECT_NEAR(i[bake::toward_right], 16 * gap * 31.5 / 64, 1e-3 * i[0]);
  EXPECT_NEAR(i[bake::toward_left], 16 * gap * (1 - 16.5 / 64), 1e-3 * i[2]);
  EXPECT_NEAR(i[bake::toward_up], 16 * gap * 39.5 / 64, 1e-3 * i[1]);
  EXPECT_NEAR(i[bake::toward_down], 16 * gap * (1 - 24.5 / 64), 1e-3 * i[3]);
}

INSTANTIATE_TEST_SUITE_P(gathers, source_test, ::testing::Values(bake::gather::read_back, bake::gather::compute),
                         [](const auto& tested) {
                           return tested.param == bake::gather::compute ? "compute" : "read_back";
                         });

class gather_test : public source_test {};

// A few thousand random polygons of all kinds around the origin; several clusters of each class.
tiny_scene cloud() {
  tiny_scene s;
  std::mt19937 engine(7);
  const auto number = [&] { return 20.0f * (static_cast<float>(engine() >> 8) / 16777216.0f - 0.5f); };
  for (int i = 0; i < 6000; ++i) {
    const look how{static_cast<scene::alpha_mode>(i % 7 < 5 ? 0 : i % 7 - 4), i % 3 == 0};
    const glm::vec3 center(number(), number(), number());
    if (glm::length(center) < 2.0f) continue;
    const auto corner = [&] { return center + 0.05f * glm::vec3(number(), number(), number()); };
    const glm::vec3 a = corner(), b = corner(), c = corner();
    s.triangle(a, b, c, how);
  }
  return s;
}

TEST_P(source_test, the_noted_pixel_shows_the_polygon) {
  tiny_scene s = cloud();
  const scene::world_geometry world = scene::flatten(s.finished());
  const bake::ray_scene rays(world, false);
  bake::pose turned = along_x;
  turned.forward = glm::normalize(glm::vec3(1, 0.03f, 0.07f));
  turned.right = glm::normalize(glm::cross(turned.forward, glm::vec3(0, 1, 0.05f)));
  turned.up = glm::cross(turned.right, turned.forward);
  bake::hemicube_view view;
  const auto drawn = source(world, GetParam());
  drawn->render(turned, view);
  EXPECT_EQ(drawn->resolution(), size);
  ASSERT_GT(view.seen.size(), 50u);
  bake::sight seen;
  std::size_t same = 0;
  for (const bake::seen_polygon& p : view.seen) {
    rays.look(turned.eye, bake::pixel_direction(turned, size, p.pixel), seen);
    same += seen.front == p.id ||
            std::any_of(seen.before.begin(), seen.before.end(), [&](const auto& b) { return b.polygon == p.id; });
  }
  // A pixel's center on an edge may be given to either side.
  EXPECT_GE(same + view.seen.size() / 200, view.seen.size());
}

void expect_same_seen(const bake::hemicube_view& a, const bake::hemicube_view& b) {
  ASSERT_EQ(a.seen.size(), b.seen.size());
  for (std::size_t i = 0; i < a.seen.size(); ++i) {
    ASSERT_EQ(a.seen[i].id, b.seen[i].id);
    ASSERT_EQ(a.seen[i].pixels, b.seen[i].pixels);
  }
}

TEST_F(gather_test, both_give_the_same_view) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  for (const std::uint32_t resolution : {16u, 50u, 128u}) {  // 50: faces that are no multiple of a work group
    const auto read_back = source(world, bake::gather::read_back, resolution, 30.0f);
    const auto compute = source(world, bake::gather::compute, resolution, 30.0f);
    bake::hemicube_view a, b;
    for (int k = 0; k < 3; ++k) {
      bake::pose from = along_x;
      from.eye.z = 0.2f * static_cast<float>(k);
      read_back->render(from, a);
      compute->render(from, b);
      EXPECT_GT(a.seen.size(), 100u);
      expect_same_seen(a, b);
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(b.importance[i], a.importance[i], 1e-4 * a.importance[i]);
    }
  }
}

TEST_F(gather_test, the_same_pose_twice_gives_the_same_view) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  bake::pose elsewhere = along_x;
  elsewhere.eye = {0, 1, 0};
  for (const bake::gather how : {bake::gather::read_back, bake::gather::compute}) {
    const auto tested = source(world, how);
    bake::hemicube_view a, b;
    tested->render(along_x, a);
    tested->render(elsewhere, b);
    tested->render(along_x, b);
    expect_same_seen(a, b);
    EXPECT_EQ(a.importance, b.importance);
  }
}

// Culling by clusters must not lose what an image of everything shows: turned frames see the same directions.
TEST_F(gather_test, a_full_turn_sees_as_much_from_any_start) {
  const scene::world_geometry world = scene::flatten(cloud().finished());
  const auto tested = source(world, bake::gather::read_back, 256);
  const auto all_around = [&](const bake::pose& from) {
    std::vector<std::uint32_t> pixels(world.kinds.size(), 0);
    bake::hemicube_view view;
    for (const float side : {1.0f, -1.0f}) {
      bake::pose p = from;
      p.forward *= side;
      p.right *= side;
      tested->render(p, view);
      for (const bake::seen_polygon& seen : view.seen) pixels[seen.id] += seen.pixels;
    }
    return pixels;
  };
  bake::pose turned;
  turned.forward = {0, 1, 0};
  turned.up = {0, 0, -1};
  turned.right = glm::cross(turned.forward, turned.up);
  const auto a = all_around(along_x), b = all_around(turned);
  // The faces of both cubes are the same six squares: the same pixels in another order.
  std::size_t different = 0;
  for (std::size_t id = 0; id < a.size(); ++id) different += (a[id] > 8) != (b[id] > 8) ? 1u : 0u;
  EXPECT_LE(different, a.size() / 100);
}

TEST_F(gather_test, wrong_options_are_refused) {
  tiny_scene s;
  s.wall_x(2, -1, 1);
  const scene::world_geometry world = scene::flatten(s.finished());
  for (const std::uint32_t resolution : {0u, 15u, 17u, 4098u}) {
    EXPECT_EQ(error_id([&] { source(world, bake::gather::automatic, resolution); }), "hemicube.resolution") << resolution;
  }
  for (const float far_plane : {0.0f, -1.0f, std::nanf("")}) {
    EXPECT_EQ(error_id([&] { source(world, bake::gather::automatic, 64, far_plane); }), "hemicube.far-plane") << far_plane;
  }
  EXPECT_EQ(error_id([] { bake::polygon_counts(0xFFFFFFFEu, 0); }), "gpu.scene-too-large");
  EXPECT_FALSE(source(world, bake::gather::automatic)->device().empty());
}

}  // namespace
