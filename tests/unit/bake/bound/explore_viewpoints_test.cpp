#include "bound/explore_viewpoints.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sightcell::bake
