#include "bound/explore_viewpoints.h"

#include <gtest/gtest.h>

#include "bound/cell_eyes.h"
#include "sightcell/format/eye_table.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::tiny_scene;

// A solid block of 8 x 4 x 8 m with closed rooms cut out of it.
struct solid_block {
  tiny_scene tiny;
  solid_block() { tiny.closed_box({-4, -2, -4}, {4, 2, 4}, false); }
  solid_block& room(const glm::vec3& min, const glm::vec3& max) {
    tiny.closed_box(min, max, true);
    return *this;
  }
};

const box own_box{{-2, -1, -2}, {2, 1, 2}};

struct exploration {
  std::optional<cell_viewpoints> found;
  std::uint64_t tests = 0;
};

exploration explore(const test::scene_with_rays& w, std::uint64_t seed = 1) {
  exploration result;
  random_stream random(seed, 7, purpose::viewpoints);
  result.found = explore_viewpoints(
      w.rays, {.own = own_box, .grown = own_box.grown(0.25f), .radius = 0.05f, .wanted = 128}, random, result.tests);
  return result;
}

TEST(explore_viewpoints, an_open_cell_is_its_own_region) {
  const test::scene_with_rays w(solid_block().room({-2, -1, -2}, {1, 1, 2}).tiny);
  const exploration r = explore(w);
  ASSERT_TRUE(r.found);
  EXPECT_TRUE(r.found->region.is_whole());
  EXPECT_EQ(r.found->outside_share, 0.0);
  EXPECT_EQ(r.found->viewpoints.size(), 128u);
  EXPECT_LT(r.tests, 600u);
}

// The free part is a closet of 0.9 x 2 x 0.9 m, 3 % of the grown box. A viewpoint costs two or three tests, not thirty.
TEST(explore_viewpoints, a_small_free_part_is_found_and_bounded) {
  const test::scene_with_rays w(solid_block().room({1, -1, 1}, {2, 1, 2}).tiny);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const exploration r = explore(w, seed);
    ASSERT_TRUE(r.found);
    EXPECT_FALSE(r.found->region.is_whole());
    EXPECT_GT(r.found->valid_share, 0.35);
    EXPECT_EQ(r.found->viewpoints.size(), 128u);
    EXPECT_LT(r.tests, 25'000u);
    EXPECT_LT(r.found->outside_share, 0.2);
    // What is left out is measured here with other points: no more of it is valid than the bound allows.
    std::uint64_t valid = 0, lost = 0;
    random_stream random(seed, 8, purpose::verify);
    const box closet{{1.05f, -0.95f, 1.05f}, {1.95f, 0.95f, 1.95f}};
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 eye = random.in_box(closet.min, closet.max);
      if (!w.rays.is_valid(eye, 0.05f)) continue;
      ++valid;
      lost += r.found->region.contains(eye) ? 0 : 1;
    }
    EXPECT_GT(valid, 1900u);
    EXPECT_LE(static_cast<double>(lost), r.found->outside_share * static_cast<double>(valid));
  }
}

TEST(explore_viewpoints, two_rooms_are_both_found) {
  const test::scene_with_rays w(solid_block().room({1, -1, 1}, {2, 1, 2}).room({-2, -1, -2}, {-1.2f, 0, -1.2f}).tiny);
  const exploration r = explore(w);
  ASSERT_TRUE(r.found);
  EXPECT_TRUE(r.found->region.contains({1.5f, 0, 1.5f}));
  EXPECT_TRUE(r.found->region.contains({-1.6f, -0.5f, -1.6f}));
}

// A slit of 3 mm has no valid viewpoint, and a corner of 7 cm in a cell of 32 cubic meters is no place to stand.
TEST(explore_viewpoints, a_sliver_is_left_out_after_few_tests) {
  for (const float width : {0.003f, 0.17f}) {
    const test::scene_with_rays w(solid_block().room({1, 0, 1}, {1 + width, 0.17f, 1.17f}).tiny);
    const exploration r = explore(w);
    EXPECT_FALSE(r.found) << width;
    EXPECT_LE(r.tests, 5000u);
  }
}

// The margin does not make a cell: only its own box does.
TEST(explore_viewpoints, a_solid_cell_beside_a_street_is_left_out) {
  const test::scene_with_rays w(solid_block().room({2, -1, -2}, {3, 1, 2}).tiny);
  EXPECT_FALSE(explore(w).found);
}

TEST(explore_viewpoints, the_result_repeats) {
  const test::scene_with_rays w(solid_block().room({1, -1, 1}, {2, 1, 2}).tiny);
  const exploration a = explore(w), b = explore(w);
  ASSERT_TRUE(a.found && b.found);
  EXPECT_EQ(a.found->region.encode(), b.found->region.encode());
  EXPECT_EQ(a.found->viewpoints, b.found->viewpoints);
  EXPECT_EQ(a.tests, b.tests);
}

std::vector<glm::vec3> positions_of(const std::vector<format::eye_steps>& eyes, const box& own) {
  std::vector<glm::vec3> positions;
  for (const format::eye_steps& eye : eyes) {
    const auto p = format::eye_position({{own.min.x, own.min.y, own.min.z}, {own.max.x, own.max.y, own.max.z}}, eye);
    positions.emplace_back(p[0], p[1], p[2]);
  }
  return positions;
}

bool is_inside(const box& b, const glm::vec3& p) {
  return glm::all(glm::greaterThanEqual(p, b.min)) && glm::all(glm::lessThan(p, b.max));
}

TEST(cell_eyes, the_eye_of_a_cell_is_valid) {
  const test::scene_with_rays w(solid_block().room({1, -1, 1}, {2, 1, 2}).tiny);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const exploration r = explore(w, seed);
    ASSERT_TRUE(r.found);
    ASSERT_FALSE(r.found->own.empty());
    for (const glm::vec3& p : r.found->own) EXPECT_TRUE(is_inside(own_box, p) && w.rays.is_valid(p, 0.05f));
    const auto eyes = choose_eyes(w.rays, own_box, r.found->region, 0.05f, r.found->viewpoints);
    ASSERT_EQ(eyes.size(), 1u) << "a cell of 4 m";
    const glm::vec3 eye = positions_of(eyes, own_box)[0];
    EXPECT_TRUE(is_inside(own_box, eye));
    EXPECT_TRUE(w.rays.is_valid(eye, 0.05f));
    EXPECT_TRUE(r.found->region.contains(eye));
  }
}

TEST(cell_eyes, wide_cells_have_eyes_apart_from_each_other) {
  tiny_scene tiny;
  const box hall{{-12, -1, -2}, {12, 1, 2}};
  tiny.closed_box(hall.min, hall.max, true);
  const test::scene_with_rays w(tiny);
  std::vector<glm::vec3> known;
  for (int i = 0; i < 60; ++i) known.emplace_back(-11.8f + 0.4f * static_cast<float>(i), 0.0f, 0.1f);
  known.emplace_back(0.0f, 0.9999f, 0.0f);  // not valid: nearer to the ceiling than the radius
  known.emplace_back(30.0f, 0.0f, 0.0f);    // not in the cell
  const auto eyes = positions_of(choose_eyes(w.rays, hall, viewpoint_region(hall), 0.05f, known), hall);
  ASSERT_EQ(eyes.size(), 3u);
  EXPECT_NEAR(eyes[0].x, 0.0f, 0.3f) << "the middle first";
  EXPECT_GT(std::abs(eyes[1].x), 11.0f);
  EXPECT_LT(eyes[1].x * eyes[2].x, -100.0f) << "then both ends";
  EXPECT_TRUE(choose_eyes(w.rays, hall, viewpoint_region(hall), 0.05f, std::span(known).last(2)).empty());
}

}  // namespace
}  // namespace sightcell::bake
