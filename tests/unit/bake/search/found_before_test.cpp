// A cell starts from what an earlier bake found: what the edit hides goes, what is still visible stays, and rays at the
// edit find what is new.
#include "search/found_before.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <optional>
#include <vector>

#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "trace/ray_scene.h"
#include "unit/bake/tiny_scene.h"

namespace sightcell::bake {
namespace {

constexpr float smallest_gap = 0.002f;
constexpr glm::vec3 eye{0.0f};
constexpr box around_eye{{-0.1f, -0.1f, -4.0f}, {0.1f, 0.1f, 4.0f}};

// Three tiles of two polygons each at x = 6, and a wall at x = 2 between the eye and the first one.
struct tiles_and_wall {
  std::uint32_t behind = 0, beside = 0, half = 0, wall = 0;  // their first polygons
  scene::scene s;
  scene::world_geometry geometry;
  ray_scene rays;

  explicit tiles_and_wall(bool has_wall = true)
      : s(made(has_wall)), geometry(scene::flatten(s)), rays(geometry, false) {}

  scene::scene made(bool has_wall) {
    test::tiny_scene tiny;
    const auto toward_eye = [&](float x, float low, float high) {
      return tiny.quad({x, -0.1f, low}, {x, -0.1f, high}, {x, 0.1f, high}, {x, 0.1f, low});
    };
    behind = toward_eye(6.0f, -0.2f, 0.2f);
    beside = toward_eye(6.0f, -4.0f, -3.0f);
    half = toward_eye(6.0f, 1.0f, 2.0f);  // the wall hides all below 1.5 of it
    if (has_wall) wall = toward_eye(2.0f, -0.5f, 0.5f);
    return tiny.finished();
  }

  edited_part part_of_wall() const {
    edited_part part{{{2.0f, -0.1f, -0.5f}, {2.0f, 0.1f, 0.5f}}, {}};
    for (std::uint32_t polygon = wall; polygon < wall + 2; ++polygon)
      part.corners.push_back(corners_of(geometry, polygon));
    return part;
  }
  edited_triangles wall_removed() const { return {{part_of_wall()}, {}, smallest_gap}; }
  edited_triangles wall_added() const { return {{}, {part_of_wall()}, smallest_gap}; }

  // What was found where there was no wall.
  cell_record record_before(const glm::vec3& witness) const {
    cell_record record;
    for (const std::uint32_t first : {behind, beside, half}) record.set.insert(record.set.end(), {first, first + 1});
    record.witnesses = {witness};
    record.witness_of.assign(record.set.size(), 0);
    return record;
  }
};

constexpr neighbor_check_settings how{.seed = 1, .place = 1, .rules = {}};

TEST(found_before, what_an_addition_hides_goes_and_nothing_else) {
  const tiles_and_wall world;
  const edited_triangles edit = world.wall_added();
  cell_set set(world.s.polygon_count);
  EXPECT_EQ(join_found_before(world.rays, {world.record_before(eye), &edit}, {}, set), 0u);
  EXPECT_FALSE(set.contains(world.behind) || set.contains(world.behind + 1));
  EXPECT_TRUE(set.contains(world.beside) && set.contains(world.beside + 1)) << "no line to it passes the wall";
  EXPECT_TRUE(set.contains(world.half) && set.contains(world.half + 1)) << "a part of it is still visible";
}

TEST(found_before, share_that_is_left) {
  const tiles_and_wall world;
  const edited_triangles edit = world.wall_added(), nothing;
  std::vector<triangle> corners;
  for (std::uint32_t polygon = 0; polygon < world.s.polygon_count; ++polygon)
    corners.push_back(corners_of(world.geometry, polygon));
  EXPECT_DOUBLE_EQ(share_left(corners, {world.record_before(eye), &edit}, 6), 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(share_left(corners, {world.record_before(eye), &edit}, 8), 0.5)
      << "two are not in the scene any more";
  EXPECT_DOUBLE_EQ(share_left(corners, {world.record_before(eye), &nothing}, 6), 1.0);
  EXPECT_DOUBLE_EQ(share_left(corners, {{}, &edit}, 0), 0.0);
}

TEST(found_before, what_is_still_seen_from_elsewhere_comes_back) {
  const tiles_and_wall world;
  const edited_triangles edit = world.wall_added();
  const found_before before{world.record_before(eye), &edit};
  cell_set set(world.s.polygon_count), beside_the_wall(world.s.polygon_count);
  (void)join_found_before(world.rays, before, {}, set);
  ASSERT_FALSE(set.contains(world.behind));
  EXPECT_GT(look_again(world.rays, around_eye, before, how, set), 0u);
  EXPECT_FALSE(set.contains(world.behind)) << "all eyes are before the wall";
  beside_the_wall.add(world.wall, {0.0f, 0.0f, 3.0f});
  (void)join_found_before(world.rays, before, {}, beside_the_wall);
  EXPECT_GT(look_again(world.rays, around_eye, before, how, beside_the_wall), 0u);
  EXPECT_TRUE(beside_the_wall.contains(world.behind) && beside_the_wall.contains(world.behind + 1));
}

TEST(found_before, without_additions_all_stays) {
  const tiles_and_wall world(false);
  const edited_triangles nothing;
  cell_set set(world.s.polygon_count);
  EXPECT_EQ(join_found_before(world.rays, {world.record_before(eye), &nothing}, {}, set), 0u);
  EXPECT_EQ(set.members().size(), 6u);
}

TEST(found_before, polygons_of_an_invalid_witness_go) {
  const tiles_and_wall world;
  const edited_triangles edit = world.wall_added();
  visibility_rules rules;
  rules.player_radius = 0.1f;
  cell_set set(world.s.polygon_count);
  const glm::vec3 too_near_the_wall{1.95f, 0.0f, 0.0f};
  (void)join_found_before(world.rays, {world.record_before(too_near_the_wall), &edit}, rules, set);
  EXPECT_TRUE(set.members().empty());
}

TEST(found_before, rays_of_a_bound_are_cast_again_where_it_can_differ) {
  const tiles_and_wall world;
  const edited_triangles edit = world.wall_added();
  found_before before{world.record_before(eye), &edit};
  cell_set set(world.s.polygon_count);
  (void)join_found_before(world.rays, before, {}, set);
  EXPECT_FALSE(bound_before(world.rays, before, smallest_gap, set)) << "there are no rays";
  before.record.of_bound = {1, 5, {1000}};
  before.record.rays = 900;
  const std::optional<cast_again> again = bound_before(world.rays, before, smallest_gap, set);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->of, before.record.of_bound);
  const auto changed = [&](const glm::vec3& direction) { return again->changed({eye, direction}); };
  EXPECT_TRUE(changed({1, 0, 0})) << "the wall, and two polygons behind it that are not in the set any more";
  EXPECT_TRUE(changed(glm::normalize(glm::vec3(2, 0, 0.49f)))) << "the wall";
  EXPECT_FALSE(changed(glm::normalize(glm::vec3(2, 0, 0.51f)))) << "beside the wall";
  EXPECT_FALSE(changed({-1, 0, 0}));
  EXPECT_TRUE(again->changed({{4, 0, 0}, {1, 0, 0}})) << "behind the wall, at the polygons that are not in the set";
  EXPECT_FALSE(again->changed({{4, 0, 0.3f}, {1, 0, 0}})) << "beside these";
  before.record.of_bound.number = 13;
  EXPECT_FALSE(bound_before(world.rays, before, smallest_gap, set)) << "too little of the confidence is left";
  before.record.of_bound.number = 1;
  before.record.bound_met = false;
  EXPECT_FALSE(bound_before(world.rays, before, smallest_gap, set));
}

TEST(found_before, rays_at_the_edit_find_what_is_new) {
  const tiles_and_wall with, without(false);
  const edited_triangles wall_added = with.wall_added(), wall_removed = with.wall_removed();
  cell_set before(with.s.polygon_count), after(without.s.polygon_count);
  before.add(with.beside, eye);
  EXPECT_GT(look_at_edit(with.rays, {{}, &wall_added}, how, before), 0u);
  EXPECT_TRUE(before.contains(with.wall) && before.contains(with.wall + 1));
  EXPECT_FALSE(before.contains(with.behind));
  after.add(without.beside, eye);
  EXPECT_GT(look_at_edit(without.rays, {{}, &wall_removed}, how, after), 0u);
  EXPECT_TRUE(after.contains(without.behind) && after.contains(without.behind + 1)) << "the wall is gone";
}

}  // namespace
}  // namespace sightcell::bake
