#include "casters/caster_search.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bound/clopper_pearson.h"
#include "casters/shadow_batch.h"
#include "unit/bake/court.h"
#include "unit/bake/gridded_room.h"

namespace sightcell::bake {
namespace {

using test::court;
using test::scene_with_rays;
using ids = std::vector<std::uint32_t>;

const viewpoint_region eyes_of_court{{-0.5f, 1.2f, 1.5f}, {0.5f, 1.8f, 2.5f}};
const sun_arc noon{{0.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};

caster_result casters_of(const scene_with_rays& w, const ids& camera, const sun_arc& sun = noon,
                         std::uint64_t most = 16'000'000, const near_polygons* beside = nullptr) {
  return find_casters(w.rays, beside, nullptr,
                      {.region = eyes_of_court, .valid_share = 1.0, .place = 3, .camera = camera}, sun,
                      {.max_error = 1e-3, .max_rays = most});
}

TEST(caster_search, finds_what_casts_shadows_into_the_view_and_nothing_else) {
  const court c;
  const scene_with_rays w(c.tiny);
  const caster_result found = casters_of(w, c.camera);
  EXPECT_EQ(found.casters, (ids{c.near_roof, c.near_roof + 1, c.far_roof, c.far_roof + 1}));
  EXPECT_TRUE(found.bound_met);
  EXPECT_LE(found.upper_bound, 1e-3);
  EXPECT_GT(found.rays, 3000u);
  EXPECT_LE(clopper_pearson_upper(found.misses, found.rays, found.confidence), found.upper_bound * 1.001);
  EXPECT_EQ(casters_of(w, c.camera, noon, 16'000'000, &w.neighbors).casters, found.casters);
}

TEST(caster_search, leaves_out_what_the_camera_set_or_another_caster_replaces) {
  court c;
  // A lid over everything but the floor's outer rim, in the camera set.
  const std::uint32_t lid =
      c.tiny.quad({-19, 20, 19}, {19, 20, 19}, {19, 20, -19}, {-19, 20, -19}, {scene::alpha_mode::opaque, true});
  const scene_with_rays w(c.tiny);
  EXPECT_GE(casters_of(w, c.camera).casters.size(), 2u);
  ids with_lid = c.camera;
  with_lid.insert(with_lid.end(), {lid, lid + 1});
  EXPECT_TRUE(casters_of(w, with_lid).casters.empty());
}

TEST(caster_search, leaves_out_shadows_on_what_the_host_does_not_draw_and_on_sides_without_light) {
  const court c;
  const scene_with_rays w(c.tiny);
  EXPECT_TRUE(casters_of(w, {c.wall, c.wall + 1}).casters.empty()) << "the wall is parallel to the light";
  EXPECT_TRUE(casters_of(w, c.camera, {{0, -1, 0}, {0, -1, 0}}).casters.empty()) << "light from below the floor";
}

TEST(caster_search, serves_all_directions_of_an_arc) {
  const court c;
  const scene_with_rays w(c.tiny);
  // From the north the light passes over the floor, and the roof beside it casts a shadow into the view.
  const glm::vec3 low = glm::normalize(glm::vec3(0.0f, 9.0f, -50.0f));
  const caster_result still = casters_of(w, c.camera, {low, low}), moving = casters_of(w, c.camera, {noon.from, low});
  EXPECT_TRUE(std::binary_search(still.casters.begin(), still.casters.end(), c.unseen_roof));
  EXPECT_FALSE(std::binary_search(still.casters.begin(), still.casters.end(), c.near_roof));
  EXPECT_TRUE(std::binary_search(moving.casters.begin(), moving.casters.end(), c.unseen_roof));
  EXPECT_TRUE(std::binary_search(moving.casters.begin(), moving.casters.end(), c.near_roof));
}

TEST(caster_search, takes_casters_of_other_cells_whose_shadow_is_visible) {
  const court c;
  const scene_with_rays w(c.tiny);
  const caster_cell cell{.region = eyes_of_court, .valid_share = 1.0, .place = 3, .camera = c.camera};
  const auto tried = [&](ids casters, const ids& candidates, const sun_arc& sun = noon) {
    EXPECT_GT(try_casters(w.rays, nullptr, cell, sun, {.max_error = 1e-3}, candidates, casters), 0u);
    return casters;
  };
  const ids all{c.floor, c.near_roof, c.near_roof + 1, c.far_roof, c.far_roof + 1, c.unseen_roof, c.unseen_roof + 1};
  EXPECT_EQ(tried({}, all), (ids{c.near_roof, c.near_roof + 1, c.far_roof, c.far_roof + 1}));
  EXPECT_EQ(tried({c.unseen_roof}, {c.far_roof}), (ids{c.far_roof, c.unseen_roof})) << "what is there stays";
  EXPECT_EQ(tried({}, {c.unseen_roof, c.unseen_roof + 1}), ids{});
  const glm::vec3 low = glm::normalize(glm::vec3(0.0f, 9.0f, -50.0f));
  EXPECT_EQ(tried({}, {c.near_roof, c.unseen_roof}, {low, low}), ids{c.unseen_roof});
}

TEST(caster_search, does_not_depend_on_the_number_of_threads) {
  const court c;
  const scene_with_rays w(c.tiny);
  caster_result one, three;
  tbb::task_arena(1).execute([&] { one = casters_of(w, c.camera); });
  tbb::task_arena(3).execute([&] { three = casters_of(w, c.camera); });
  EXPECT_EQ(one.casters, three.casters);
  EXPECT_EQ(one.rays, three.rays);
  EXPECT_EQ(one.upper_bound, three.upper_bound);
  EXPECT_EQ(one.rays_spent, three.rays_spent);
}

TEST(caster_search, ends_above_the_bound_when_its_rays_are_spent) {
  const court c;
  const scene_with_rays w(c.tiny);
  const caster_result found = casters_of(w, c.camera, noon, 100);
  EXPECT_FALSE(found.bound_met);
  EXPECT_GT(found.upper_bound, 1e-3);
  EXPECT_LT(found.rays_spent, 40'000u);
}

// The share of the directions in which a miss is seen, against the same share by counting.
TEST(shadow_batch, counts_each_ray_whose_visible_point_lacks_its_shadow) {
  const court c;
  const scene_with_rays w(c.tiny);
  const caster_sets sets{[&](std::uint32_t p) { return p < 4; },
                         [&](std::uint32_t p) { return p < 4 || p >= c.far_roof; }};
  shadow_batch batch(w.rays, eyes_of_court, 0.05f, 1.0, noon, {1, 1, purpose::caster_bound, 1}, sets);
  batch.cast(100'000);
  std::uint64_t misses = 0;
  random_stream random(5, 5, purpose::jitter);
  sight seen;
  for (int i = 0; i < 100'000; ++i) {
    const glm::vec3 eye = eyes_of_court.draw(random), direction = random.on_sphere();
    w.rays.trace(eye, direction, seen);
    if (seen.front != c.floor && seen.front != c.floor + 1) continue;
    const glm::vec3 point = eye + seen.distance * direction;
    if (std::abs(point.x) < 3.0f && point.z < -4.0f && point.z > -8.0f) ++misses;
  }
  EXPECT_GT(misses, 400u);
  EXPECT_NEAR(static_cast<double>(batch.misses()), static_cast<double>(misses),
              5.0 * std::sqrt(2.0 * static_cast<double>(misses)));
  EXPECT_LE(batch.trials(0.01), 100'000u);
  EXPECT_GT(batch.trials(0.01), 97'000u);
}

TEST(shadow_batch, from_given_viewpoints_finds_the_same_and_counts_no_trials) {
  const court c;
  const scene_with_rays w(c.tiny);
  const caster_sets sets{[&](std::uint32_t p) { return p < 4; },
                         [&](std::uint32_t p) { return p < 4 || p >= c.far_roof; }};
  shadow_batch batch(w.rays, eyes_of_court, 0.05f, 1.0, noon, {1, 1, purpose::caster_search, 1}, sets);
  const std::vector<glm::vec3> eyes{{0.0f, 1.5f, 2.0f}, {0.25f, 1.7f, 1.75f}};
  batch.cast_from(eyes, 40'000);
  EXPECT_GT(batch.misses(), 150u);
  EXPECT_EQ(batch.spent(), 40'000u);
  EXPECT_EQ(batch.trials(0.01), batch.misses()) << "no viewpoint was tested, so nothing is known to be a trial";
  for (const missed_shadow& one : batch.missed()) {
    EXPECT_TRUE(one.eye == eyes[0] || one.eye == eyes[1]);
    EXPECT_TRUE(
        std::find(one.lacking.one_of.begin(), one.lacking.one_of.end(), c.near_roof) != one.lacking.one_of.end() ||
        std::find(one.lacking.one_of.begin(), one.lacking.one_of.end(), c.near_roof + 1) != one.lacking.one_of.end());
  }
}

}  // namespace
}  // namespace sightcell::bake
